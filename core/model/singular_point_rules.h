#pragma once

#include "core/model/segment2.h"

#include <algorithm>
#include <vector>

namespace paperbake {

/// Rules of the artist for the singular points of a crumple, given on the pattern before it begins.
struct SingularPointRules {
  std::vector<Vector2d> fixed;  // [m] singular points that exist from the first frame on
  std::vector<Disc> forbidden;  // no singular point is born in these

  bool forbids(const Vector2d& p) const {
    return std::any_of(forbidden.begin(), forbidden.end(),
                       [&](const Disc& d) { return (p - d.centre).norm() <= d.radius; });
  }

  void append(const SingularPointRules& more) {
    fixed.insert(fixed.end(), more.fixed.begin(), more.fixed.end());
    forbidden.insert(forbidden.end(), more.forbidden.begin(), more.forbidden.end());
  }
};

}  // namespace paperbake
