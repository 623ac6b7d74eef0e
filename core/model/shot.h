#pragma once

#include "core/model/authored_surface.h"
#include "core/model/handles.h"
#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "core/model/singular_point_rules.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

class Collider;  // core/geometry/collider.h
using Colliders = std::vector<Collider>;

/// Handles that hold the paper on both sides of a prescribed crease like two hands, and so fold it.
struct FoldingHands {
  int crease;  // index into Pattern::prescribed_creases

  // |F| [rad] dihedral angle between the two hands: element f is of frame first_frame + f of the
  // scene; not a number where one of them does not hold
  std::vector<double> turn;
  Vector2d between;  // [m] a point of the pattern between the two hands
  // paper that no hand holds, but that has to turn with the hands of two other lines: only the part
  // of the crease that lies on the same side of this crease as `between`
  std::optional<int> beyond = {};
};

/// One sheet and everything that is done to it.
struct Shot {
  std::string sheet_name;
  Pattern pattern;
  Sheet start;                  // a mesh of the sheet at the first frame: pattern, x, triangles
  std::vector<Handle> handles;  // row 0 of keyed is first_frame
  Paper paper;
  SingularPointRules singular_point_rules = {};
  std::vector<FoldingHands> hands = {};
  // with their fronts turned towards this sheet; null: there are none
  std::shared_ptr<const Colliders> colliders = nullptr;
  // uv sets and materials that come back with the cache; null: there are none
  std::shared_ptr<const AuthoredSurface> authored = nullptr;
};

}  // namespace paperbake
