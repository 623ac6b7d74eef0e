#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The flat shape that was cut out of paper: simple polygons that do not touch each other, without
/// repeating the first vertex at the end. The bounding box begins at (0, 0).
struct Pattern {
  std::vector<Vector2d> outline;                          // [m] counter-clockwise
  std::vector<std::vector<Vector2d>> holes;               // [m] clockwise
  std::vector<PrescribedCrease> prescribed_creases = {};  // creases within it
};

Vector2d extent(const Pattern&);      // [m] width and height of the bounding box
double longer_side(const Pattern&);   // [m] one unit of the render uv
double shorter_side(const Pattern&);  // [m]
/// [m] Area over length, which is the distance of two points of the outline that lie far apart: for
/// a strip its width, wherever it points to. Of a ring or a spiral it tells nothing: these are
/// longer than any straight line in them.
double mean_width(const Pattern&);
double area(const Pattern&);  // [m2] without the holes

/// True if p lies inside the pattern or within `tolerance` [m] of its border.
bool contains(const Pattern&, const Vector2d& p, double tolerance = 0);

/// [m] The point of the border (outline and holes) that is closest to p.
Vector2d nearest_border_point(const Pattern&, const Vector2d& p);

/// [m] Length of the shortest path from a to b inside the pattern: the farthest that the paper lets
/// the two be apart. Both points lie inside or on the border. The path is straight where nothing is
/// in the way, else it bends at re-entrant corners.
double paper_distance(const Pattern&, const Vector2d& a, const Vector2d& b);

}  // namespace paperbake
