#include "core/step1_elastic/contact/separation_bound.h"

#include "core/geometry/mesh_edges.h"
#include "core/model/segment2.h"

#include <Eigen/Eigenvalues>

#include <array>

namespace paperbake {
namespace {

using Matrix32 = Eigen::Matrix<double, 3, 2>;

/// True if every vertex lies to the left of every border edge.
bool is_convex(const Points2& pattern, const Triangles& triangles) {
  for (const auto& [from, to] : border_of(MeshEdges(triangles))) {
    const Eigen::RowVector2d a = pattern.row(from), e = pattern.row(to) - a;
    const double least = -1e-9 * e.squaredNorm();
    for (int v = 0; v < pattern.rows(); ++v)
      if (const Eigen::RowVector2d p = pattern.row(v) - a; cross(e, p) < least) return false;
  }
  return true;
}

/// The nearest matrix with orthonormal columns; zero if there is none.
Matrix32 orthonormal(const Matrix32& m) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> gram;
  gram.computeDirect(m.transpose() * m);
  if (!(gram.eigenvalues()[0] > 1e-6 * gram.eigenvalues()[1])) return Matrix32::Zero();
  return m * gram.operatorInverseSqrt();
}

}  // namespace

SeparationBound::SeparationBound(const Points2& pattern, const Triangles& triangles)
    : triangles_(triangles), convex_(is_convex(pattern, triangles)) {
  if (!convex_) return;
  rest_.reserve(triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t)
    rest_.push_back(rest_triangle(pattern, triangles.row(t)));
}

bool SeparationBound::holds_along_step(const Points3& from, const Points3& to, double share) const {
  if (!convex_) return false;
  const auto F = [&](const Points3& x, int t) -> Matrix32 {
    Matrix32 sum = x.row(triangles_(t, 0)).transpose() * rest_[t].g.row(0);
    for (int i = 1; i < 3; ++i) sum += x.row(triangles_(t, i)).transpose() * rest_[t].g.row(i);
    return sum;
  };
  std::vector<std::array<Matrix32, 2>> ends(triangles_.rows());
  Matrix32 mean = Matrix32::Zero();
  for (int t = 0; t < triangles_.rows(); ++t) {
    ends[t] = {F(from, t), F(to, t)};
    mean += rest_[t].area * (ends[t][0] + ends[t][1]);
  }
  const Eigen::Matrix<double, 2, 3> seen = orthonormal(mean).transpose();
  for (const auto& both : ends)
    for (const Matrix32& deformed : both) {
      const Eigen::Matrix2d J = seen * deformed;
      const double a = J(0, 0) - share, b = J(1, 1) - share, c = 0.5 * (J(0, 1) + J(1, 0));
      if (!(a > 0 && b > 0 && a * b >= c * c)) return false;
    }
  return true;
}

}  // namespace paperbake
