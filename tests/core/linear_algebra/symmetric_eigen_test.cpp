#include "core/linear_algebra/symmetric_eigen.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

Eigen::Matrix2d symmetric(double a, double b, double c) {
  Eigen::Matrix2d M;
  M << a, b, b, c;
  return M;
}

TEST(SymmetricEigen, OfTwoRowsIsTheClosedForm) {
  for (const double size : {1e-200, 1e-9, 1.0, 1e200}) {
    const SymmetricEigen<2> eigen = symmetric_eigen(Eigen::Matrix2d(size * symmetric(2, 3, -1)));
    EXPECT_NEAR(eigen.values[0] / size, (1 - std::sqrt(45)) / 2, 1e-14);
    EXPECT_NEAR(eigen.values[1] / size, (1 + std::sqrt(45)) / 2, 1e-14);
  }
}

TEST(SymmetricEigen, PutsTheMatrixTogetherAgain) {
  for (const Eigen::Matrix2d& M :
       {symmetric(2, 3, -1), symmetric(1, 1e-20, 1), symmetric(3, 0, 1), symmetric(1, 1, 1),
        symmetric(0, 0, 0), symmetric(1e-9, -3e-8, 7e-8), symmetric(5e11, 2, 1e-3)}) {
    const auto [values, vectors] = symmetric_eigen(M);
    EXPECT_LE(values[0], values[1]);
    EXPECT_TRUE((vectors.transpose() * vectors).isIdentity(1e-15)) << M;
    EXPECT_LE((vectors * values.asDiagonal() * vectors.transpose() - M).norm(), 1e-15 * M.norm())
        << M;
  }
}

TEST(SymmetricEigen, ReadsTheLowerTriangle) {
  Eigen::Matrix2d two = symmetric(2, 3, -1);
  Eigen::Matrix3d three = Eigen::Vector3d(1, 2, 3) * Eigen::RowVector3d(1, 2, 3);
  three.diagonal() += Eigen::Vector3d(4, 0, -1);
  const SymmetricEigen<2> of_two = symmetric_eigen(two);
  const SymmetricEigen<3> of_three = symmetric_eigen(three);
  EXPECT_LT((of_three.vectors * of_three.values.asDiagonal() * of_three.vectors.transpose() - three)
                .norm(),
            1e-13);
  two(0, 1) = NAN;
  three(0, 1) = three(0, 2) = three(1, 2) = NAN;
  EXPECT_EQ(symmetric_eigen(two).vectors, of_two.vectors);
  EXPECT_EQ(symmetric_eigen(three).values, of_three.values);
}

}  // namespace
}  // namespace paperbake
