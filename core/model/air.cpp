#include "core/model/air.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// Noise of mean 0 and variance 1: waves whose frequencies have no common measure.
double gust_noise(unsigned seed, double time) {
  constexpr double slowest = 0.3;  // [1/s]
  constexpr double ratio = 1.41;   // [1]
  constexpr int waves = 8;
  double sum = 0;
  for (int k = 0; k < waves; ++k) {
    // phase from the golden ratio and the seed
    const double turn = std::fmod(0.6180339887498949 * (k + 1.0) * (seed % 65536 + 1.0), 1.0);
    sum += std::sin(2 * M_PI * (slowest * std::pow(ratio, k) * time + turn));
  }
  return sum * std::sqrt(2.0 / waves);
}

}  // namespace

Vector3d air_velocity(const Air& air, double time, const Vector3d& p) {
  Vector3d sum = Vector3d::Zero();
  for (const Wind& wind : air.winds) {
    if (wind.velocity.rows() == 0) continue;
    const double last = static_cast<double>(wind.velocity.rows() - 1),
                 row = std::clamp(time * air.fps, 0.0, last);
    const auto before = static_cast<Eigen::Index>(row);
    const Eigen::Index after = std::min<Eigen::Index>(before + 1, wind.velocity.rows() - 1);
    const double share = row - static_cast<double>(before);
    const Vector3d v = (1 - share) * wind.velocity.row(before) + share * wind.velocity.row(after);
    const double speed2 = v.squaredNorm();
    if (speed2 == 0) continue;
    sum += wind.gust == 0
               ? v
               : Vector3d((1 + wind.gust * gust_noise(wind.seed, time - v.dot(p) / speed2)) * v);
  }
  return sum;
}

}  // namespace paperbake
