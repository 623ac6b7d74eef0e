#pragma once

#include "core/sheet.h"

#include <vector>

namespace paperbake {

/// What an artist fixes of a crumple before it begins, on the pattern.
struct Pins {
  struct Disc {
    Vector2d centre;  // [m]
    double radius;    // [m]
  };
  struct Crease {
    std::vector<Vector2d> line;  // [m] polyline, at least two points
    double angle = 0;            // [rad] that it springs back to; > 0 bulges towards the normals
  };
  std::vector<Vector2d> keep;    // [m] singular points from the first frame on
  std::vector<Disc> forbid;      // none is born here
  std::vector<Crease> creases;   // folded before the first frame: they bend easily there

  void append(const Pins& more) {
    keep.insert(keep.end(), more.keep.begin(), more.keep.end());
    forbid.insert(forbid.end(), more.forbid.begin(), more.forbid.end());
    creases.insert(creases.end(), more.creases.begin(), more.creases.end());
  }
};

}  // namespace paperbake
