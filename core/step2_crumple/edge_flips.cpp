#include "core/step2_crumple/edge_flips.h"

#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/geometry/prescribed_creases.h"
#include "core/geometry/proximity.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace paperbake {
namespace {

using Eigen::Matrix2d;

/// |S|: the tensor with its eigenvalues made positive.
Matrix2d magnitude(const Vector3d& tensor) {
  const Principal p = principal_curvature(tensor);
  const Vector2d along(-p.across.y(), p.across.x());
  return std::abs(p.k1) * p.across * p.across.transpose() +
         std::abs(p.k2) * along * along.transpose();
}

double twice_area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Edge 0-1 with wings 2 (left) and 3 (right) may become edge 3-2.
bool may_flip(const Sheet& sheet, const std::array<int, 4>& v) {
  constexpr double min_share = 0.08, max_compression = 0.03, max_fold = 2.2;
  const auto p = [&](int k) -> Vector2d { return sheet.pattern.row(v[k]); };
  const double pair = twice_area(p(0), p(1), p(2)) + twice_area(p(1), p(0), p(3));
  if (std::min(twice_area(p(0), p(3), p(2)), twice_area(p(3), p(1), p(2))) < min_share * pair)
    return false;
  if ((sheet.x.row(v[2]) - sheet.x.row(v[3])).norm() < (1 - max_compression) * (p(2) - p(3)).norm())
    return false;
  const Hinge turned{{v[3], v[2], v[0], v[1]}, {0, 0}};  // left of 3 -> 2 lies corner 0
  return std::abs(dihedral_angle(sheet.x, turned)) <= max_fold;
}

/// The sheet passes through nothing when it turns that edge.
bool has_room(const Sheet& sheet, const Hinge& hinge) {
  constexpr double clearance = 0.005;  // of the new edge
  const auto& v = hinge.vertices;
  const auto at = [&](int k) -> Vector3d { return sheet.x.row(v[k]); };
  return tetrahedron_is_empty(sheet, v, {at(0), at(1), at(2), at(3)},
                              {hinge.triangles[0], hinge.triangles[1]},
                              clearance * (at(2) - at(3)).norm());
}

}  // namespace

int flip_towards_rulings(Sheet& sheet, const Points3& curvature, double gain) {
  constexpr int passes = 6;
  constexpr double flat = 0.3;  // [1/m]
  std::vector<Matrix2d> metric(sheet.pattern.rows());
  for (std::size_t v = 0; v < metric.size(); ++v)
    metric[v] = magnitude(curvature.row(v)) + flat * Matrix2d::Identity();

  int flips = 0;
  for (int pass = 0; pass < passes; ++pass) {
    const int before = flips;
    std::vector<char> touched(sheet.triangles.rows(), 0);
    for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
      const auto [left, right] = hinge.triangles;
      if (touched[left] || touched[right]) continue;
      const auto& v = hinge.vertices;
      if (is_on_crease(sheet.prescribed_creases, sheet.pattern, v[0], v[1])) continue;
      const Matrix2d M = 0.25 * (metric[v[0]] + metric[v[1]] + metric[v[2]] + metric[v[3]]);
      const Vector2d old_edge = (sheet.pattern.row(v[1]) - sheet.pattern.row(v[0])).transpose();
      const Vector2d new_edge = (sheet.pattern.row(v[3]) - sheet.pattern.row(v[2])).transpose();
      if (new_edge.dot(M * new_edge) >= gain * old_edge.dot(M * old_edge) || !may_flip(sheet, v) ||
          !has_room(sheet, hinge))
        continue;
      sheet.triangles.row(left) << v[0], v[3], v[2];
      sheet.triangles.row(right) << v[3], v[1], v[2];
      touched[left] = touched[right] = 1;
      ++flips;
    }
    if (flips == before) break;
  }
  return flips;
}

}  // namespace paperbake
