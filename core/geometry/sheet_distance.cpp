#include "core/geometry/sheet_distance.h"

#include "core/geometry/box_of.h"
#include "core/geometry/box_tree.h"
#include "core/geometry/point_location.h"
#include "core/geometry/proximity.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

namespace paperbake {
namespace {

double distance_of(const Sheet& a, int s, const Sheet& b, int t) {
  const TriangleCorners p = corners_of(a.x, a.triangles, s), q = corners_of(b.x, b.triangles, t);
  for (int i = 0; i < 3; ++i)
    if (pierces(p[i], p[(i + 1) % 3], q) || pierces(q[i], q[(i + 1) % 3], p)) return 0;
  return feature_distance(p, q);
}

}  // namespace

/// Calls visit(triangle of a, triangle of b) for all pairs whose boxes are closer than `within`.
template <class Visit>
static void for_each_near(const Sheet& a, const Sheet& b, const double& within, Visit visit) {
  const Eigen::AlignedBox3d near_a = grown(box_of(a.x), within),
                            near_b = grown(box_of(b.x), within);
  if (!near_a.intersects(box_of(b.x))) return;
  std::vector<int> of_b;  // triangles that reach near a
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int t = 0; t < b.triangles.rows(); ++t)
    if (const auto box = box_of(corners_of(b.x, b.triangles, t)); box.intersects(near_a)) {
      of_b.push_back(t);
      boxes.push_back(box);
    }
  BoxTree tree;
  tree.build(boxes);
  for (int s = 0; s < a.triangles.rows(); ++s) {
    const auto box = box_of(corners_of(a.x, a.triangles, s));
    if (!box.intersects(near_b)) continue;
    tree.visit(grown(box, within), [&](int k) {
      if (box.squaredExteriorDistance(boxes[k]) < within * within) visit(s, of_b[k]);
    });
  }
}

double distance_between(const Sheet& a, const Sheet& b, double within) {
  double least = within;
  for_each_near(a, b, least,
                [&](int s, int t) { least = std::min(least, distance_of(a, s, b, t)); });
  return least;
}

double distance_of_inside(const Pattern& pattern, const Sheet& sheet, const Sheet& other,
                          double within) {
  constexpr int along = 16;
  if (!grown(box_of(sheet.x), within).intersects(box_of(other.x))) return within;
  const PointLocator locator(sheet.pattern, sheet.triangles);
  const Vector2d cell = extent(pattern) / along;
  const double from_border = 0.49 * cell.minCoeff();
  std::vector<std::vector<Vector3d>> inside(sheet.triangles.rows());
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < along; ++j) {
      const Vector2d p = cell.cwiseProduct(Vector2d(i + 0.5, j + 0.5));
      if (!contains(pattern, p, 0) || (nearest_border_point(pattern, p) - p).norm() < from_border)
        continue;
      const MeshPoint at = locator.locate(p);
      inside[at.triangle].push_back(interpolate(at, sheet.triangles, sheet.x));
    }
  double least = within;
  for_each_near(sheet, other, least, [&](int s, int t) {
    const auto corner = [&](int i) -> Vector3d { return other.x.row(other.triangles(t, i)); };
    for (const Vector3d& p : inside[s])
      least = std::min(least, vertex_to_triangle({p, corner(0), corner(1), corner(2)}).distance());
  });
  return least;
}

double share_within(const Sheet& a, const Sheet& b, double distance) {
  std::vector<char> near_a(a.x.rows(), 0), near_b(b.x.rows(), 0);
  const auto mark = [&](const Sheet& one, int s, const Sheet& other, int t,
                        std::vector<char>& near) {
    const auto corner = [&](int i) -> Vector3d { return other.x.row(other.triangles(t, i)); };
    for (const int v : one.triangles.row(s))
      if (!near[v])
        near[v] = vertex_to_triangle({Vector3d(one.x.row(v)), corner(0), corner(1), corner(2)})
                      .distance() < distance;
  };
  for_each_near(a, b, distance, [&](int s, int t) {
    mark(a, s, b, t, near_a);
    mark(b, t, a, s, near_b);
  });
  const auto count =
      std::count(near_a.begin(), near_a.end(), 1) + std::count(near_b.begin(), near_b.end(), 1);
  return static_cast<double>(count) / static_cast<double>(near_a.size() + near_b.size());
}

}  // namespace paperbake
