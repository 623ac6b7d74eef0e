#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

enum class HandleMode {
  absolute,  // the sheet point goes where the handle is
  relative,  // the sheet point's own position at the grab frame + the handle's motion since
};

/// A point of the sheet that an artist moves. It holds a position only; the paper may turn about
/// it.
struct Handle {
  std::string name;  // full name of the node
  Vector2d pattern;  // [m]  the sheet point it holds
  // |F|x3 [m] world, z up: row f = frame first_frame + f of its SheetScene
  Points3 keyed;
  HandleMode mode = HandleMode::absolute;
  int grab_frame = std::numeric_limits<int>::min();     // held from this frame (included) ...
  int release_frame = std::numeric_limits<int>::max();  // ... to this one (excluded)
  // [m]  paper_radius; 0: a bare point; none: a lone handle gets a finger's size
  std::optional<double> radius;
  double stiffness = 0;  // [N/m] 0: hard

  bool held(int frame) const { return grab_frame <= frame && frame < release_frame; }
};

/// Where the DCC has the handle; before its first and after its last key it rests.
/// row  frame - first frame of the scene
Vector3d keyed_position(const Handle&, int row);

/// Size of the disc that a handle holds stiff, as a finger would: its `radius` when it has one;
/// else 0 in a row of handles and 10 mm (at most 5 % of the shorter side) for a lone one: no other
/// held point within 30 mm, or 15 % of the shorter side where that is less. [m]
double disc_radius(const std::vector<Handle>&, std::size_t handle, const Pattern&);

/// Vertices on the rim of a disc on the pattern: six on a whole circle, the same spacing and both
/// ends where the border cuts it. Empty for radius 0. [m]
std::vector<Vector2d> disc_rim(const Pattern&, const Vector2d& centre, double radius);

}  // namespace paperbake
