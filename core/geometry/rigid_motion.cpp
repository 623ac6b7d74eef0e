#include "core/geometry/rigid_motion.h"

#include <Eigen/SVD>

namespace paperbake {

using Eigen::Matrix3d;

RigidMotion nearest_rigid_motion(const Points3& points, const Points3& targets) {
  const Vector3d from = points.colwise().mean(), to = targets.colwise().mean();
  Matrix3d covariance = Matrix3d::Zero();
  for (Eigen::Index k = 0; k < points.rows(); ++k)
    covariance += (targets.row(k).transpose() - to) * (points.row(k) - from.transpose());
  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d proper = Matrix3d::Identity();
  proper(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3d turn = svd.matrixU() * proper * svd.matrixV().transpose();
  return {turn, to - turn * from};
}

}  // namespace paperbake
