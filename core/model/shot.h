#pragma once

#include "core/model/authored_surface.h"
#include "core/model/handles.h"
#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/segment2.h"
#include "core/model/sheet.h"
#include "core/model/singular_point_rules.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

class Collider;  // core/geometry/collider.h
using Colliders = std::vector<Collider>;

/// Handles that hold the paper on both sides of a line like two hands, and so fold it there.
struct FoldingHands {
  Segment2 line;                // [m] from border to border
  std::vector<Segment2> parts;  // [m] the straight parts of prescribed creases that run along it

  // |F| [rad] dihedral angle between the two hands: element f is of frame first_frame + f of the
  // scene; not a number where one of them does not hold
  std::vector<double> turn;
  Vector2d between;  // [m] a point of the pattern between the two hands
  // paper that no hand holds, but that has to turn with these hands and others where their lines
  // cross: only the part of the line that lies on the same side of the other line as `between`
  struct Beyond {
    int own, others;  // indices into Shot::hands
  };
  std::optional<Beyond> beyond = {};
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
