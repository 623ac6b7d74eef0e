#pragma once

#include "core/model/sheet.h"

#include <algorithm>
#include <vector>

namespace paperbake {

/// What an artist fixes of a crumple before it begins, on the pattern.
struct SingularPointRules {
  struct Disc {
    Vector2d centre;  // [m]
    double radius;    // [m]
  };
  std::vector<Vector2d> keep;  // [m] singular points from the first frame on
  std::vector<Disc> forbid;    // none is born here

  bool forbids(const Vector2d& p) const {
    return std::any_of(forbid.begin(), forbid.end(),
                       [&](const Disc& d) { return (p - d.centre).norm() <= d.radius; });
  }

  void append(const SingularPointRules& more) {
    keep.insert(keep.end(), more.keep.begin(), more.keep.end());
    forbid.insert(forbid.end(), more.forbid.begin(), more.forbid.end());
  }
};

}  // namespace paperbake
