#include "core/render/turnable_edges.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

// [rad] smallest angle of a triangle that a flip may make: 8 degrees
constexpr double min_turned = 0.14;

}  // namespace

TurnableEdges::TurnableEdges(const Points2& pattern, Triangles& triangles)
    : pattern_(pattern), triangles_(triangles) {
  for (int t = 0; t < triangles.rows(); ++t) enter(t);
}

bool TurnableEdges::has(int a, int b) const { return left_.count({a, b}) || left_.count({b, a}); }

bool TurnableEdges::turn_to(int a, int b, const std::set<std::pair<int, int>>& keep) {
  for (auto it = left_.lower_bound({a, -1}); it != left_.end() && it->first.first == a; ++it) {
    const int c = it->first.second, t = it->second, d = third(t, a, c);
    const auto beyond = left_.find({d, c});
    if (beyond == left_.end() || keep.count(std::minmax(c, d)) || third(beyond->second, d, c) != b)
      continue;
    if (std::min(min_angle(a, c, b), min_angle(a, b, d)) < min_turned) return false;
    const int other = beyond->second;
    for (const auto& edge : {std::pair<int, int>(a, c), {c, d}, {d, a}, {d, c}, {c, b}, {b, d}})
      left_.erase(edge);
    triangles_.row(t) << a, c, b;
    triangles_.row(other) << a, b, d;
    enter(t);
    enter(other);
    return true;
  }
  return false;
}

int TurnableEdges::between(int a, int b, double off) const {
  const Vector2d along = (pattern_.row(b) - pattern_.row(a)).normalized();
  for (auto it = left_.lower_bound({a, -1}); it != left_.end() && it->first.first == a; ++it) {
    const int v = it->first.second;
    const Vector2d p = pattern_.row(v) - pattern_.row(a);
    if (has(v, b) && std::abs(cross(p, along)) < off) return v;
  }
  return -1;
}

void TurnableEdges::enter(int t) {
  for (int i = 0; i < 3; ++i) left_[{triangles_(t, i), triangles_(t, (i + 1) % 3)}] = t;
}

int TurnableEdges::third(int t, int a, int b) const { return triangles_.row(t).sum() - a - b; }

/// Smallest angle of a triangle; negative when it is turned over. [rad]
double TurnableEdges::min_angle(int a, int b, int c) const {
  double least = M_PI;
  const int v[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    const Vector2d u = pattern_.row(v[(i + 1) % 3]) - pattern_.row(v[i]),
                   w = pattern_.row(v[(i + 2) % 3]) - pattern_.row(v[i]);
    least = std::min(least, std::atan2(cross(u, w), u.dot(w)));
  }
  return least;
}

}  // namespace paperbake
