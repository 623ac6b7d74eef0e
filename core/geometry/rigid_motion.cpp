#include "core/geometry/rigid_motion.h"

#include "core/geometry/measure.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace paperbake {
namespace {

/// The motion that takes the middle `from` to the middle `to` and maximises trace(R covariance^T).
RigidMotion best_aligned(const Matrix3d& covariance, const Vector3d& from, const Vector3d& to) {
  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d proper = Matrix3d::Identity();
  proper(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3d turn = svd.matrixU() * proper * svd.matrixV().transpose();
  return {turn, to - turn * from};
}

}  // namespace

RigidMotion half_of(const RigidMotion& motion) {
  Eigen::AngleAxisd about(motion.turn);
  about.angle() *= 0.5;
  const Matrix3d turn = about.toRotationMatrix();
  return {turn, (turn + Matrix3d::Identity()).inverse() * motion.shift};
}

Vector3d half_way(const RigidMotion& motion, const Vector3d& from, const Vector3d& target) {
  return half_of(motion)(from) + 0.5 * (target - motion(from));
}

Points3 moved(const RigidMotion& motion, const Points3& points) {
  return (points * motion.turn.transpose()).rowwise() + motion.shift.transpose();
}

RigidMotion nearest_rigid_motion(const Points3& points, const Points3& targets) {
  const Vector3d from = points.colwise().mean(), to = targets.colwise().mean();
  Matrix3d covariance = Matrix3d::Zero();
  for (Eigen::Index k = 0; k < points.rows(); ++k)
    covariance += (targets.row(k).transpose() - to) * (points.row(k) - from.transpose());
  return best_aligned(covariance, from, to);
}

std::optional<RigidMotion> rigid_motion_between(const Points3& points, const Points3& targets,
                                                double slack) {
  const RigidMotion motion = nearest_rigid_motion(points, targets);
  if (!(max_row_norm(moved(motion, points) - targets) <= slack)) return std::nullopt;
  return motion;
}

RigidMotion nearest_rigid_motion(const Points3& points, const Points3& targets,
                                 const Eigen::VectorXd& weights) {
  const double all = weights.sum();
  const Vector3d from = points.transpose() * weights / all,
                 to = targets.transpose() * weights / all;
  Matrix3d covariance = Matrix3d::Zero();
  for (Eigen::Index k = 0; k < points.rows(); ++k)
    covariance +=
        weights[k] * (targets.row(k).transpose() - to) * (points.row(k) - from.transpose());
  return best_aligned(covariance, from, to);
}

RigidMotion motion_with_held(const Points3& points, const Points3& targets,
                             const std::vector<int>& held) {
  constexpr double much = 1e3;  // [1] weight of a held point against all free ones
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.rows());
  for (const int v : held) weights[v] = much * static_cast<double>(points.rows());
  return nearest_rigid_motion(points, targets, weights);
}

}  // namespace paperbake
