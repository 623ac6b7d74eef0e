#include "core/geometry/intersections.h"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <array>
#include <cstddef>
#include <vector>

// Intersections are counted with the exact predicates of CGAL, so that the count does not depend on
// the solver's own contact code.

namespace paperbake {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;

// number of boxes below which CGAL tests all pairs; its default of 10 takes three times as long on
// a sheet
constexpr std::ptrdiff_t scanned = 1000;

/// True when the edge p-q passes through the interior of triangle t.
bool pierces(const Point& p, const Point& q, const std::array<Point, 3>& t) {
  const auto above = CGAL::orientation(t[0], t[1], t[2], p),
             below = CGAL::orientation(t[0], t[1], t[2], q);
  if (above == CGAL::COPLANAR || below == CGAL::COPLANAR || above == below) return false;
  const auto s0 = CGAL::orientation(p, q, t[0], t[1]), s1 = CGAL::orientation(p, q, t[1], t[2]),
             s2 = CGAL::orientation(p, q, t[2], t[0]);
  return s0 == s1 && s1 == s2 && s0 != CGAL::COPLANAR;
}

std::array<Point, 3> corners(const Sheet& sheet, int t) {
  const auto at = [&](int v) { return Point(sheet.x(v, 0), sheet.x(v, 1), sheet.x(v, 2)); };
  return {at(sheet.triangles(t, 0)), at(sheet.triangles(t, 1)), at(sheet.triangles(t, 2))};
}

bool cross(const std::array<Point, 3>& p, const std::array<Point, 3>& q) {
  for (int i = 0; i < 3; ++i)
    if (pierces(p[(i + 1) % 3], p[(i + 2) % 3], q) || pierces(q[(i + 1) % 3], q[(i + 2) % 3], p))
      return true;
  return false;
}

/// True when triangles s and t of a mesh intersect.
bool cross(const Sheet& sheet, int s, int t) {
  int shared = 0, of_s = -1, of_t = -1;  // number of common corners; the last one in s and in t
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (sheet.triangles(s, i) == sheet.triangles(t, j)) {
        ++shared;
        of_s = i;
        of_t = j;
      }
  if (shared > 1) return false;
  const auto p = corners(sheet, s), q = corners(sheet, t);
  if (shared == 0) return cross(p, q);
  // triangles with a common corner can intersect only by the edges opposite that corner
  return pierces(p[(of_s + 1) % 3], p[(of_s + 2) % 3], q) ||
         pierces(q[(of_t + 1) % 3], q[(of_t + 2) % 3], p);
}

std::vector<Box> boxes_of(const Sheet& sheet) {
  std::vector<Box> boxes;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto p = corners(sheet, t);
    boxes.emplace_back(p[0].bbox() + p[1].bbox() + p[2].bbox(), t);
  }
  return boxes;
}

}  // namespace

int crossings(const Sheet& sheet) {
  std::vector<Box> boxes = boxes_of(sheet);
  int count = 0;
  CGAL::box_self_intersection_d(
      boxes.begin(), boxes.end(),
      [&](const Box& a, const Box& b) { count += cross(sheet, a.info(), b.info()); }, scanned);
  return count;
}

int crossings_between(const Sheet& one, const Sheet& other) {
  std::vector<Box> ones = boxes_of(one), others = boxes_of(other);
  int count = 0;
  CGAL::box_intersection_d(
      ones.begin(), ones.end(), others.begin(), others.end(),
      [&](const Box& a, const Box& b) {
        count += cross(corners(one, a.info()), corners(other, b.info()));
      },
      scanned);
  return count;
}

}  // namespace paperbake
