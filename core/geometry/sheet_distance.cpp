#include "core/geometry/sheet_distance.h"

#include "core/geometry/box_of.h"
#include "core/geometry/point_location.h"
#include "core/geometry/proximity.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace paperbake {
namespace {

struct Boxed {
  Eigen::AlignedBox3d box;
  int triangle;
};

/// Triangles whose boxes reach into `part`, sorted by their lower end along x.
std::vector<Boxed> boxes_in(const Sheet& sheet, const Eigen::AlignedBox3d& part) {
  std::vector<Boxed> boxes;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    Eigen::AlignedBox3d box;
    for (int i = 0; i < 3; ++i) box.extend(Vector3d(sheet.x.row(sheet.triangles(t, i))));
    if (box.intersects(part)) boxes.push_back({box, t});
  }
  const auto place = [](const Boxed& b) { return std::make_pair(b.box.min().x(), b.triangle); };
  std::sort(boxes.begin(), boxes.end(),
            [&](const Boxed& a, const Boxed& b) { return place(a) < place(b); });
  return boxes;
}

double distance_of(const Sheet& a, int s, const Sheet& b, int t) {
  std::array<Vector3d, 3> p, q;
  for (int i = 0; i < 3; ++i) {
    p[i] = a.x.row(a.triangles(s, i));
    q[i] = b.x.row(b.triangles(t, i));
  }
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    least = std::min({least, vertex_to_triangle({p[i], q[0], q[1], q[2]}).distance(),
                      vertex_to_triangle({q[i], p[0], p[1], p[2]}).distance()});
    if (pierces(p[i], p[(i + 1) % 3], q) || pierces(q[i], q[(i + 1) % 3], p)) return 0;
    for (int j = 0; j < 3; ++j)
      least =
          std::min(least, edge_to_edge({p[i], p[(i + 1) % 3], q[j], q[(j + 1) % 3]}).distance());
  }
  return least;
}

}  // namespace

/// Calls visit(triangle of a, triangle of b) for all pairs whose boxes are closer than `within`.
template <class Visit>
static void for_each_near(const Sheet& a, const Sheet& b, const double& within, Visit visit) {
  if (!grown(box_of(a.x), within).intersects(box_of(b.x))) return;
  const std::vector<Boxed> of_a = boxes_in(a, grown(box_of(b.x), within)),
                           of_b = boxes_in(b, grown(box_of(a.x), within));
  double widest = 0;
  for (const Boxed& other : of_b) widest = std::max(widest, other.box.sizes().x());
  for (const Boxed& one : of_a) {
    const auto lower = [](const Boxed& other, double x) { return other.box.min().x() < x; };
    const auto first =
        std::lower_bound(of_b.begin(), of_b.end(), one.box.min().x() - widest - within, lower);
    for (auto other = first;
         other != of_b.end() && other->box.min().x() <= one.box.max().x() + within; ++other)
      if (one.box.squaredExteriorDistance(other->box) < within * within)
        visit(one.triangle, other->triangle);
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
