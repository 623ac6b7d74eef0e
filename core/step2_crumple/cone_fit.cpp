#include "core/step2_crumple/cone_fit.h"

#include "core/linear_algebra/symmetric_eigen.h"

namespace paperbake {

Vector2d Cone::ruling(const Vector2d& p) const {
  const Vector2d d = apex.head<2>() - apex.z() * (p - centre) / scale;
  return d.norm() > 0 ? Vector2d(d.normalized()) : Vector2d(1, 0);
}

Cone fit_cone(const std::vector<RulingSample>& samples, double scale,
              double cylinder_regularization) {
  Cone cone;
  cone.scale = scale;
  double weight = 0;
  for (const RulingSample& s : samples) {
    cone.centre += s.weight * s.p;
    weight += s.weight;
  }
  if (weight <= 0) return cone;
  cone.centre /= weight;
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (const RulingSample& s : samples) {
    const Vector3d q(s.across.x(), s.across.y(), -s.across.dot(s.p - cone.centre) / scale);
    const Vector3d w = s.weight * q;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r <= c; ++r) M(c, r) += w[c] * q[r];  // the lower triangle
  }
  M /= weight;
  M(2, 2) += cylinder_regularization;
  cone.apex = symmetric_eigen(M).vectors.col(0);
  return cone;
}

}  // namespace paperbake
