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

}  // namespace

int crossings(const Sheet& sheet) {
  const auto at = [&](int v) { return Point(sheet.x(v, 0), sheet.x(v, 1), sheet.x(v, 2)); };
  const auto triangle = [&](int t) {
    return std::array<Point, 3>{at(sheet.triangles(t, 0)), at(sheet.triangles(t, 1)), at(sheet.triangles(t, 2))};
  };
  std::vector<Box> boxes;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto p = triangle(t);
    boxes.emplace_back(p[0].bbox() + p[1].bbox() + p[2].bbox(), t);
  }
  int count = 0;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    int shared = 0, of_a = -1, of_b = -1;  // corners in common; the last of them
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (sheet.triangles(a.info(), i) == sheet.triangles(b.info(), j)) ++shared, of_a = i, of_b = j;
    if (shared > 1) return;
    // round a shared corner only the edges opposite to it can pass through the other triangle
    const auto p = triangle(a.info()), q = triangle(b.info());
    bool crossing = false;
    for (int i = 0; i < 3; ++i) {
      if (shared == 0 || i == of_a) crossing |= pierces(p[(i + 1) % 3], p[(i + 2) % 3], q);
      if (shared == 0 || i == of_b) crossing |= pierces(q[(i + 1) % 3], q[(i + 2) % 3], p);
    }
    count += crossing;
  });
  return count;
}

}  // namespace paperbake
