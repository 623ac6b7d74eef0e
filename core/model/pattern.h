#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The flat shape that was cut out of paper: simple polygons, not touching each other, no vertex
/// repeated at the end. Its bounding box begins at (0, 0).
struct Pattern {
  std::vector<Vector2d> outline;                          // [m] counter-clockwise
  std::vector<std::vector<Vector2d>> holes;               // [m] clockwise
  std::vector<PrescribedCrease> prescribed_creases = {};  // within it
};

Vector2d extent(const Pattern&);      // [m]  width and height of the bounding box
double longer_side(const Pattern&);   // [m]  1 unit of the render uv
double shorter_side(const Pattern&);  // [m]
double area(const Pattern&);          // [m2] holes taken off

/// True when p lies inside the pattern or within `tolerance` [m] of its border.
bool contains(const Pattern&, const Vector2d& p, double tolerance = 0);

/// The nearest point of the border (outline and holes) to p. [m]
Vector2d nearest_border_point(const Pattern&, const Vector2d& p);

/// Length of the shortest path from a to b inside the pattern: as far as paper lets the two be
/// apart. [m] Both lie inside or on the border. Straight where nothing is in the way, else along
/// re-entrant corners.
double paper_distance(const Pattern&, const Vector2d& a, const Vector2d& b);

}  // namespace paperbake
