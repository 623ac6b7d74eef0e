#pragma once

#include "core/model/sheet.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

/// Where the straight line through way.a and way.b meets a segment, as a share of the way [1]: 0 is
/// way.a, 1 is way.b. Nothing: it does not, or nearly runs along the segment.
inline std::optional<double> meeting(const Segment2& way, const Segment2& segment) {
  constexpr double rounding = 1e-9;  // [1] of the segment
  constexpr double parallel = 0.02;  // [1] sine of an angle
  const Vector2d along = way.b - way.a, across = segment.b - segment.a, apart = segment.a - way.a;
  const double turned = cross(along, across);
  if (std::abs(turned) <= parallel * along.norm() * across.norm()) return std::nullopt;
  const double at = cross(apart, along) / turned;
  if (std::abs(at - 0.5) > 0.5 + rounding) return std::nullopt;
  return cross(apart, across) / turned;
}

/// Whether the straight line through a segment runs between these two points.
inline bool separates(const Segment2& line, const Vector2d& p, const Vector2d& q) {
  const Vector2d along = line.b - line.a;
  return cross(along, p - line.a) * cross(along, q - line.a) < 0;
}

/// Whether two segments cross, both within their ends.
inline bool crosses(const Segment2& one, const Segment2& two) {
  return separates(one, two.a, two.b) && separates(two, one.a, one.b);
}

}  // namespace paperbake
