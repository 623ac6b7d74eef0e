#include "core/methods/adaptive_mesh/sizing_field.h"

#include "core/geometry/developable_curvature.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <vector>

namespace paperbake {
namespace {

using Eigen::Matrix2d;

/// The matrix with the same eigenvectors and the eigenvalues f.
template <class Function>
Matrix2d spectral(const Matrix2d& M, const Function& f) {
  Eigen::SelfAdjointEigenSolver<Matrix2d> solver;
  solver.computeDirect(M);
  const Vector2d values(f(solver.eigenvalues()[0]), f(solver.eigenvalues()[1]));
  return solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose();
}

/// The coarsest metric that is at least as fine as A and B. A is positive definite.
Matrix2d finer(const Matrix2d& A, const Matrix2d& B) {
  const Matrix2d more = A - B;
  if (more.trace() >= 0 && more.determinant() >= 0) return A;
  const Eigen::LLT<Matrix2d> root(A);
  const Matrix2d L = root.matrixL();
  const Matrix2d inverse = L.inverse();
  const Matrix2d both =
      spectral(inverse * B * inverse.transpose(), [](double v) { return std::max(1.0, v); });
  return L * both * L.transpose();
}

double twice_area(const Sheet& sheet, int t) {
  const auto p = [&](int i) -> Vector2d { return sheet.pattern.row(sheet.triangles(t, i)); };
  return cross(p(1) - p(0), p(2) - p(0));
}

/// The metric with its sizes limited to their bounds.
Matrix2d bounded(const Matrix2d& M, double longest, double shortest, double aspect) {
  const SymmetricEigen<2> eigen = symmetric_eigen(M);
  Vector2d values =
      eigen.values.cwiseMax(1 / (longest * longest)).cwiseMin(1 / (shortest * shortest));
  values = values.cwiseMax(values.maxCoeff() / (aspect * aspect));
  return eigen.vectors * values.asDiagonal() * eigen.vectors.transpose();
}

/// Limits the growth of sizes: seen from either end of an edge, the field at the other end may be
/// coarser by `growth` if the edge has length 1 in the metric.
void ease(const Sheet& sheet, std::vector<Matrix2d>& metric, double growth) {
  constexpr int sweeps = 4;
  const auto spread = [&](int from, int to) {
    const Vector2d d = (sheet.pattern.row(to) - sheet.pattern.row(from)).transpose();
    const double factor = 1 + (growth - 1) * std::sqrt(d.dot(metric[from] * d));
    metric[to] = finer(metric[to], metric[from] / (factor * factor));
  };
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int t = 0; t < sheet.triangles.rows(); ++t)
      for (int i = 0; i < 3; ++i) {
        const int a = sheet.triangles(t, i), b = sheet.triangles(t, (i + 1) % 3);
        spread(a, b);
        spread(b, a);
      }
}

}  // namespace

Points3 sizing_field(const Sheet& sheet, const Points3& kept, double side,
                     const SizingOptions& options) {
  const int vertices = static_cast<int>(sheet.pattern.rows());
  double area = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t) area += 0.5 * twice_area(sheet, t);
  const double longest = options.largest * std::sqrt(area), shortest = options.smallest * side;

  const Points3 curvature = developable_curvature(sheet);
  std::vector<Matrix2d> metric(vertices);
  const double turn = 1 / (options.edge_turn * options.edge_turn);
  for (int v = 0; v < vertices; ++v) {
    Matrix2d M = Matrix2d::Identity() / (longest * longest);
    const Matrix2d S = symmetric_matrix(curvature.row(v));
    M = finer(M, turn * S * S);
    if (kept.rows()) {
      const Matrix2d Sp = symmetric_matrix(kept.row(v));
      M = finer(M, turn * Sp * Sp);
    }
    metric[v] = bounded(M, longest, shortest, options.aspect);
  }
  ease(sheet, metric, options.growth);
  Points3 field(vertices, 3);
  for (int v = 0; v < vertices; ++v)
    field.row(v) << metric[v](0, 0), metric[v](0, 1), metric[v](1, 1);
  return field;
}

double triangles_of(const Sheet& sheet, const Points3& metric) {
  // [1] area of a triangle in its metric after edges were split until none is longer than 1,
  // measured
  constexpr double of_one = 0.19;
  double sum = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const Eigen::RowVector3d m =
        (metric.row(sheet.triangles(t, 0)) + metric.row(sheet.triangles(t, 1)) +
         metric.row(sheet.triangles(t, 2))) /
        3;
    sum += 0.5 * twice_area(sheet, t) * std::sqrt(m[0] * m[2] - m[1] * m[1]);
  }
  return sum / of_one;
}

}  // namespace paperbake
