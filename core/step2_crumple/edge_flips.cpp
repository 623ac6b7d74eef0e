#include "core/step2_crumple/edge_flips.h"

#include "core/geometry/curvature.h"
#include "core/geometry/edge_operations.h"

#include <cmath>
#include <vector>

namespace paperbake {
namespace {

using Eigen::Matrix2d;

/// |S|: the tensor with its eigenvalues replaced by their magnitudes.
Matrix2d magnitude(const Vector3d& tensor) {
  const Principal p = principal_curvature(tensor);
  const Vector2d along(-p.across.y(), p.across.x());
  return std::abs(p.k1) * p.across * p.across.transpose() +
         std::abs(p.k2) * along * along.transpose();
}

}  // namespace

int flip_towards_rulings(Sheet& sheet, const Points3& curvature, double gain) {
  constexpr double flat = 0.3;          // [1/m]
  constexpr double least_share = 0.08;  // [1] of the area of both triangles
  std::vector<Matrix2d> metric(sheet.pattern.rows());
  for (std::size_t v = 0; v < metric.size(); ++v)
    metric[v] = magnitude(curvature.row(v)) + flat * Matrix2d::Identity();

  return flip_edges(sheet, least_share, [&](const Hinge& hinge) {
    const auto& v = hinge.vertices;
    const Matrix2d M = 0.25 * (metric[v[0]] + metric[v[1]] + metric[v[2]] + metric[v[3]]);
    const Vector2d old_edge = (sheet.pattern.row(v[1]) - sheet.pattern.row(v[0])).transpose();
    const Vector2d new_edge = (sheet.pattern.row(v[3]) - sheet.pattern.row(v[2])).transpose();
    return new_edge.dot(M * new_edge) < gain * old_edge.dot(M * old_edge);
  });
}

}  // namespace paperbake
