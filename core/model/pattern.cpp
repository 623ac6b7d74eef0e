#include "core/model/pattern.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

namespace paperbake {
namespace {

double signed_area(const std::vector<Vector2d>& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    twice += cross(loop[i], loop[(i + 1) % loop.size()]);
  return twice / 2;
}

/// Calls visit(previous, from, to) for every border edge from -> to; the paper is on its left.
template <class Visit>
void for_each_edge(const Pattern& pattern, Visit visit) {
  const auto walk = [&](const std::vector<Vector2d>& loop) {
    const std::size_t n = loop.size();
    for (std::size_t i = 0; i < n; ++i) visit(loop[(i + n - 1) % n], loop[i], loop[(i + 1) % n]);
  };
  walk(pattern.outline);
  for (const auto& hole : pattern.holes) walk(hole);
}

/// [m] Lengths below this are rounding errors: coordinates come from 32-bit files, 1e-7 of the
/// sheet.
double rounding(const Pattern& pattern) { return 1e-7 * longer_side(pattern); }

/// Parameters on the segment a -> b at which it meets or leaves the border.
std::vector<double> border_crossings(const Pattern& pattern, const Vector2d& a, const Vector2d& b,
                                     double tolerance) {
  const Vector2d ab = b - a;
  const double length = ab.norm();
  std::vector<double> t = {0, 1};
  const auto add = [&](double s) {
    if (0 < s && s < 1) t.push_back(s);
  };
  for_each_edge(pattern, [&](const Vector2d&, const Vector2d& p, const Vector2d& q) {
    const double side_p = cross(ab, p - a) / length, side_q = cross(ab, q - a) / length;
    // corners on the line divide it, which covers edges along the line and paths through a corner
    if (std::abs(side_p) <= tolerance) add((p - a).dot(ab) / (length * length));
    if ((side_p < 0) != (side_q < 0))
      add((p + side_p / (side_p - side_q) * (q - p) - a).dot(ab) / (length * length));
  });
  std::sort(t.begin(), t.end());
  return t;
}

/// True if the straight line a-b stays in the pattern; it may touch the border or run along it.
bool sees(const Pattern& pattern, const Vector2d& a, const Vector2d& b) {
  const double tolerance = rounding(pattern), length = (b - a).norm();
  if (length <= tolerance) return true;
  // between two crossings the line is either inside or outside: its midpoint decides
  const std::vector<double> t = border_crossings(pattern, a, b, tolerance);
  for (std::size_t i = 1; i < t.size(); ++i) {
    if ((t[i] - t[i - 1]) * length <= tolerance) continue;
    if (!contains(pattern, a + (t[i] + t[i - 1]) / 2 * (b - a), tolerance)) return false;
  }
  return true;
}

/// Corners with more than 180 degrees of paper: the only points at which a shortest path bends.
std::vector<Vector2d> reentrant_corners(const Pattern& pattern) {
  std::vector<Vector2d> corners;
  for_each_edge(pattern,
                [&](const Vector2d& before, const Vector2d& corner, const Vector2d& after) {
                  if (cross(corner - before, after - corner) < 0) corners.push_back(corner);
                });
  return corners;
}

/// A* on the visibility graph of `points`, from points[0] to points[1]. Lines of sight are tested
/// only when they are needed.
double min_path(const Pattern& pattern, const std::vector<Vector2d>& points) {
  struct Route {
    double at_least, so_far;
    std::size_t point, from;
    bool operator>(const Route& other) const { return at_least > other.at_least; }
  };
  const auto left = [&](std::size_t i) { return (points[i] - points[1]).norm(); };
  std::vector<bool> done(points.size(), false);
  std::priority_queue<Route, std::vector<Route>, std::greater<Route>> routes;
  routes.push({left(0), 0, 0, 0});
  while (!routes.empty()) {
    const Route route = routes.top();
    routes.pop();
    if (done[route.point] || !sees(pattern, points[route.from], points[route.point])) continue;
    if (route.point == 1) return route.so_far;
    done[route.point] = true;
    for (std::size_t next = 1; next < points.size(); ++next) {
      if (done[next]) continue;
      const double so_far = route.so_far + (points[next] - points[route.point]).norm();
      routes.push({so_far + left(next), so_far, next, route.point});
    }
  }
  // only if the pattern is not in one piece: the straight line is the only safe answer
  return left(0);
}

}  // namespace

Vector2d extent(const Pattern& pattern) {
  if (pattern.outline.empty()) return Vector2d::Zero();
  Vector2d low = pattern.outline.front(), high = low;
  for (const Vector2d& p : pattern.outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return high - low;
}

double longer_side(const Pattern& pattern) { return extent(pattern).maxCoeff(); }

double shorter_side(const Pattern& pattern) { return extent(pattern).minCoeff(); }

double mean_width(const Pattern& pattern) {
  const auto farthest_from = [&](const Vector2d& from) {
    return *std::max_element(pattern.outline.begin(), pattern.outline.end(),
                             [&](const Vector2d& p, const Vector2d& q) {
                               return (p - from).squaredNorm() < (q - from).squaredNorm();
                             });
  };
  const Vector2d end = farthest_from(pattern.outline.front());
  return area(pattern) / (farthest_from(end) - end).norm();
}

double area(const Pattern& pattern) {
  double sum = signed_area(pattern.outline);
  for (const auto& hole : pattern.holes) sum += signed_area(hole);  // clockwise: negative
  return sum;
}

bool contains(const Pattern& pattern, const Vector2d& p, double tolerance) {
  bool inside = false;
  double nearest2 = std::numeric_limits<double>::infinity();
  for_each_edge(pattern, [&](const Vector2d&, const Vector2d& a, const Vector2d& b) {
    nearest2 = std::min(nearest2, (nearest_on_segment(p, a, b) - p).squaredNorm());
    if ((a.y() > p.y()) == (b.y() > p.y())) return;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  });
  // the border belongs to the pattern: a point computed to lie on it may be off by some 1e-16
  return inside || std::sqrt(nearest2) <= tolerance + 1e-14 * longer_side(pattern);
}

Vector2d nearest_border_point(const Pattern& pattern, const Vector2d& p) {
  Vector2d nearest = p;
  double nearest2 = std::numeric_limits<double>::infinity();
  for_each_edge(pattern, [&](const Vector2d&, const Vector2d& a, const Vector2d& b) {
    const Vector2d candidate = nearest_on_segment(p, a, b);
    const double distance2 = (candidate - p).squaredNorm();
    if (distance2 < nearest2) {
      nearest2 = distance2;
      nearest = candidate;
    }
  });
  return nearest;
}

double paper_distance(const Pattern& pattern, const Vector2d& a, const Vector2d& b) {
  const auto into_paper = [&](const Vector2d& p) {
    return contains(pattern, p) ? p : nearest_border_point(pattern, p);
  };
  std::vector<Vector2d> points = {into_paper(a), into_paper(b)};
  if (sees(pattern, points[0], points[1])) return (a - b).norm();
  const std::vector<Vector2d> corners = reentrant_corners(pattern);
  points.insert(points.end(), corners.begin(), corners.end());
  return min_path(pattern, points);
}

}  // namespace paperbake
