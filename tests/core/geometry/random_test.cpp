#include "core/geometry/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

TEST(RandomTest, GaussianDrawsHaveMeanZeroDeviationOneAndNoCorrelation) {
  constexpr int n = 20000;
  Vector2d mean(0, 0);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (int k = 0; k < n; ++k) {
    const Vector2d g = gaussian({7, 0, static_cast<std::uint32_t>(k)}, 0);
    mean += g / n;
    scatter += g * g.transpose() / n;
  }
  const double error = 4 / std::sqrt(double(n));  // four standard errors
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), error);
  EXPECT_NEAR(scatter(0, 0), 1, 1.5 * error);
  EXPECT_NEAR(scatter(1, 1), 1, 1.5 * error);
  EXPECT_NEAR(scatter(0, 1), 0, error);
}

}  // namespace
}  // namespace paperbake
