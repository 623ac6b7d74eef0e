#include "core/step1_elastic/contact/friction.h"

#include <Eigen/Eigenvalues>

#include <utility>

namespace paperbake {

FrictionMollifier friction_mollifier(double y, double epsilon) {
  if (y >= epsilon) return {y, 1, 0};
  const double s = y / epsilon;
  return {epsilon * (-s * s * s / 3 + s * s + 1.0 / 3), s * (2 - s), 2 * (1 - s) / epsilon};
}

FrictionMollifierInPlane friction_mollifier(const Eigen::Vector2d& slip, double epsilon) {
  const double length = slip.norm(), least = 1e-6 * epsilon;
  const FrictionMollifier f = friction_mollifier(length, epsilon);
  const double across = length > least ? f.slope / length : 2 / epsilon;
  Eigen::Matrix2d second = across * Eigen::Matrix2d::Identity();
  if (length > least) second += (f.second - across) / (length * length) * slip * slip.transpose();
  return {f.value, across, second};
}

Eigen::Matrix<double, 3, 2> tangents_of(const Vector3d& normal) {
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = normal.unitOrthogonal();
  tangents.col(1) = normal.cross(tangents.col(0));
  return tangents;
}

std::array<Eigen::Matrix<double, 2, 3>, 4> sliding_map(const std::array<Vector3d, 4>& x,
                                                       Features features,
                                                       const ClosestPoints& near) {
  // [1] roughly a squared sine: two nearly parallel sides do not show a rotation about themselves
  constexpr double alike = 0.05;
  const double d = near.distance();
  const Vector3d n = near.apart / d;
  const Eigen::Matrix<double, 3, 2> tangents = tangents_of(n);
  std::array<Eigen::Matrix<double, 2, 3>, 4> along;
  for (int i = 0; i < 4; ++i) along[i] = near.weights[i] * tangents.transpose();

  // n rotates by h in the plane across it. Every side p of the features demands p.h = -n.(move of
  // p); h is the least-squares solution
  const bool edges = features == Features::two_edges;
  const std::array<std::pair<int, int>, 2> sides{edges ? std::pair{0, 1} : std::pair{1, 2},
                                                 edges ? std::pair{2, 3} : std::pair{1, 3}};
  std::array<Eigen::Vector2d, 2> q;
  std::array<double, 2> length;
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  for (int k = 0; k < 2; ++k) {
    const Vector3d p = x[sides[k].second] - x[sides[k].first];
    length[k] = p.norm();
    q[k] = tangents.transpose() * p / length[k];
    A += q[k] * q[k].transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(A);
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
  for (int e = 0; e < 2; ++e)
    if (const double value = solver.eigenvalues()[e]; value > alike)
      inverse += solver.eigenvectors().col(e) * solver.eigenvectors().col(e).transpose() / value;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Matrix<double, 2, 3> turned = (d / length[k]) * (inverse * q[k]) * n.transpose();
    along[sides[k].second] += turned;
    along[sides[k].first] -= turned;
  }
  return along;
}

}  // namespace paperbake
