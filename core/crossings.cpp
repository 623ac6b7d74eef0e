#include "core/measure.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/Box_intersection_d/Box_with_info_d.h>

#include <array>

// Counted by CGAL with exact predicates: an answer that does not come from the solver's own contact code.

namespace paperbake {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;

/// An edge of one triangle passes through the inside of the other.
bool pierces(const Point& p, const Point& q, const std::array<Point, 3>& t) {
  const auto above = CGAL::orientation(t[0], t[1], t[2], p), below = CGAL::orientation(t[0], t[1], t[2], q);
  if (above == CGAL::COPLANAR || below == CGAL::COPLANAR || above == below) return false;
  const auto s0 = CGAL::orientation(p, q, t[0], t[1]), s1 = CGAL::orientation(p, q, t[1], t[2]), s2 = CGAL::orientation(p, q, t[2], t[0]);
  return s0 == s1 && s1 == s2 && s0 != CGAL::COPLANAR;
}

/// Triangles s and t of a mesh pass through each other.
bool cross(const Points3& x, const Triangles& triangles, int s, int t) {
  int shared = 0, of_s = -1, of_t = -1;  // corners in common; the last of them
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (triangles(s, i) == triangles(t, j)) ++shared, of_s = i, of_t = j;
  if (shared > 1) return false;
  const auto corners = [&](int of) {
    const auto at = [&](int v) { return Point(x(v, 0), x(v, 1), x(v, 2)); };
    return std::array<Point, 3>{at(triangles(of, 0)), at(triangles(of, 1)), at(triangles(of, 2))};
  };
  // round a shared corner only the edges opposite to it can pass through the other triangle
  const auto p = corners(s), q = corners(t);
  for (int i = 0; i < 3; ++i) {
    if ((shared == 0 || i == of_s) && pierces(p[(i + 1) % 3], p[(i + 2) % 3], q)) return true;
    if ((shared == 0 || i == of_t) && pierces(q[(i + 1) % 3], q[(i + 2) % 3], p)) return true;
  }
  return false;
}

}  // namespace

int crossings(const Sheet& sheet) {
  const auto at = [&](int t, int i) { const auto p = sheet.x.row(sheet.triangles(t, i)); return Point(p[0], p[1], p[2]).bbox(); };
  std::vector<Box> boxes;
  for (int t = 0; t < sheet.triangles.rows(); ++t) boxes.emplace_back(at(t, 0) + at(t, 1) + at(t, 2), t);
  int count = 0;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { count += cross(sheet.x, sheet.triangles, a.info(), b.info()); });
  return count;
}

}  // namespace paperbake
