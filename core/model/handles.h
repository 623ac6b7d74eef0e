#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

enum class HandleMode {
  absolute,  // the point of the sheet goes where the handle is
  relative,  // position of the sheet's point at the grab frame + motion of the handle since then
};

/// A point of the sheet that an artist moves. It holds a position only; the paper may rotate about
/// it.
struct Handle {
  std::string name;  // full name of the node
  Vector2d pattern;  // [m] the point of the sheet that it holds
  // |F|x3 [m] world, z up: row f is frame first_frame + f of the scene
  Points3 keyed;
  HandleMode mode = HandleMode::absolute;
  int grab_frame = std::numeric_limits<int>::min();     // held from this frame (included) ...
  int release_frame = std::numeric_limits<int>::max();  // ... to this one (excluded)
  // [m] paper_radius; 0: a bare point; none: a lone handle has the size of a finger
  std::optional<double> radius = {};
  double stiffness = 0;  // [N/m] 0: hard

  bool held(int frame) const { return grab_frame <= frame && frame < release_frame; }
};

/// [m] Position of the handle in the scene; it rests before its first and after its last key.
/// row  frame - first frame of the scene
Vector3d keyed_position(const Handle&, int row);

/// [m] Radius of the disc that a handle holds stiff, as a finger would: its own `radius` if it has
/// one; else 0 in a row of handles, and 10 mm (at most 5 % of the shorter side) for a lone handle.
/// A handle is alone if no other held point is within 30 mm, or 15 % of the shorter side where that
/// is less.
double disc_radius(const std::vector<Handle>&, std::size_t handle, const Pattern&);

/// [m] Vertices on the rim of a disc on the pattern: six on a whole circle; where the border cuts
/// it, points at about the same spacing and at both ends of each arc. Empty for radius 0.
std::vector<Vector2d> disc_rim(const Pattern&, const Vector2d& centre, double radius);

}  // namespace paperbake
