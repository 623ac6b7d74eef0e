#include "core/geometry/principal_axes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

TEST(PrincipalAxes, AreThoseOfABoxThatIsTurnedAndMoved) {
  const Vector3d half(3, 0.5, 2);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Points3 corners(8, 3);
  for (int k = 0; k < 8; ++k) {
    const Vector3d signs(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    corners.row(k) = turn * signs.cwiseProduct(half) + Vector3d(10, -20, 30);
  }
  const SymmetricEigen<3> axes = principal_axes(corners);
  const int by_size[] = {1, 2, 0};  // axes of the box, the shortest first
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(axes.values[i], 8 * std::pow(half[by_size[i]], 2), 1e-12);
    EXPECT_NEAR(std::abs(axes.vectors.col(i).dot(turn.col(by_size[i]))), 1, 1e-14);
  }
}

}  // namespace
}  // namespace paperbake
