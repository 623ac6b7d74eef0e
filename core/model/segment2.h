#pragma once

#include "core/model/sheet.h"

#include <algorithm>

namespace paperbake {

/// z component of the cross product of two vectors in the plane: twice the signed area of the
/// triangle 0, a, b; positive when b lies counter-clockwise of a.
inline double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Distance from p to the segment a-b, which may be a single point.
inline double distance_to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double t = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return (p - a - t * along).norm();
}

/// A straight line between two points of a pattern. [m]
struct Segment2 {
  Vector2d a, b;
};

/// Whether the line of a segment runs between these two points.
inline bool separates(const Segment2& line, const Vector2d& p, const Vector2d& q) {
  const Vector2d along = line.b - line.a;
  return cross(along, p - line.a) * cross(along, q - line.a) < 0;
}

}  // namespace paperbake
