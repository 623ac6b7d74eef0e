#include "core/step1_elastic/friction.h"

namespace paperbake {

Sliding sliding(double y, double epsilon) {
  if (y >= epsilon) return {y, 1, 0};
  const double s = y / epsilon;
  return {epsilon * (-s * s * s / 3 + s * s + 1.0 / 3), s * (2 - s), 2 * (1 - s) / epsilon};
}

SlidingInPlane sliding(const Eigen::Vector2d& slid, double epsilon) {
  const double way = slid.norm(), least = 1e-6 * epsilon;
  const Sliding f = sliding(way, epsilon);
  const double across = way > least ? f.slope / way : 2 / epsilon;
  Eigen::Matrix2d second = across * Eigen::Matrix2d::Identity();
  if (way > least) second += (f.second - across) / (way * way) * slid * slid.transpose();
  return {f.value, across, second};
}

}  // namespace paperbake
