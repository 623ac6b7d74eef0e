#pragma once

#include "core/model/sheet.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace paperbake {

/// z component of the cross product of two vectors in the plane: twice the signed area of the
/// triangle 0, a, b; positive when b lies counter-clockwise of a.
inline double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Area of the triangle a, b, c, > 0 when it is counter-clockwise.
inline double signed_area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return 0.5 * cross(b - a, c - a);
}

/// Barycentric coordinates of p in the triangle a, b, c, also outside it. [1]
inline Vector3d barycentric(const Vector2d& p, const Vector2d& a, const Vector2d& b,
                            const Vector2d& c) {
  const Vector2d u = b - a, v = c - a, q = p - a;
  const double doubled = cross(u, v), at_b = cross(q, v) / doubled, at_c = cross(u, q) / doubled;
  return {1 - at_b - at_c, at_b, at_c};
}

/// Where the segment a-b, which may be a single point, comes nearest to p, as a share of the way
/// from a to b. [1]
inline double nearest_share(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  return std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
}

/// The point of the segment a-b that is nearest to p.
inline Vector2d nearest_on_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  return a + nearest_share(p, a, b) * (b - a);
}

/// Distance from p to the segment a-b.
inline double distance_to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  return (p - a - nearest_share(p, a, b) * (b - a)).norm();
}

/// A disc on a pattern.
struct Disc {
  Vector2d centre;  // [m]
  double radius;    // [m]
};

/// A straight line between two points of a pattern. [m]
struct Segment2 {
  Vector2d a, b;
};

/// A straight line through p + share along.
struct Line2 {
  Vector2d p, along;
};

/// The line through a segment; the share is 0 at a and 1 at b.
inline Line2 line_through(const Segment2& s) { return {s.a, s.b - s.a}; }

/// Where two lines meet, as the share on each. [1]
struct LinesMeet {
  double on_first, on_second;
};

/// parallel  [1] sine of an angle; nothing is returned for lines at no larger angle
inline std::optional<LinesMeet> where_lines_meet(const Line2& first, const Line2& second,
                                                 double parallel) {
  const Vector2d apart = second.p - first.p;
  const double doubled = cross(first.along, second.along);
  if (std::abs(doubled) <= parallel * first.along.norm() * second.along.norm()) return std::nullopt;
  return LinesMeet{cross(apart, second.along) / doubled, cross(apart, first.along) / doubled};
}

/// Where the straight line through way.a and way.b meets a segment, as a share of the way [1]: 0 is
/// way.a, 1 is way.b. Nothing: it does not, or nearly runs along the segment.
inline std::optional<double> meeting(const Segment2& way, const Segment2& segment) {
  constexpr double rounding = 1e-9;  // [1] of the segment
  constexpr double parallel = 0.02;  // [1] sine of an angle
  const std::optional<LinesMeet> meet =
      where_lines_meet(line_through(way), line_through(segment), parallel);
  if (!meet || std::abs(meet->on_second - 0.5) > 0.5 + rounding) return std::nullopt;
  return meet->on_first;
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
