#include "core/linear_algebra/column_cholesky.h"

#include "core/model/error.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <random>

namespace paperbake {
namespace {

/// Vertices of a square grid, each coupled to all within this reach; the diagonal outweighs its
/// row, so the matrix is positive definite.
Eigen::MatrixXd grid_matrix(int side, int reach, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int n = side * side;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      if (std::abs(i / side - j / side) <= reach && std::abs(i % side - j % side) <= reach)
        all(i, j) = all(j, i) = uniform(random);
  for (int i = 0; i < n; ++i) all(i, i) = 0.1 + all.row(i).cwiseAbs().sum();
  return all;
}

/// [1] error of the solution, as a part of its norm
double error_of(const Eigen::MatrixXd& matrix) {
  const Points3 x = Points3::Random(matrix.rows(), 3);
  const Eigen::MatrixXd lower = matrix.triangularView<Eigen::Lower>();
  const Points3 found = ColumnCholesky(lower.sparseView()).solve(matrix * x);
  return (found - x).norm() / x.norm();
}

// 32 bits have 6e-8; the condition numbers are below 1e3
constexpr double rounding = 1e-5;

TEST(ColumnCholeskyTest, SolvesSystemsWhoseColumnsFormPanelsOfManyWidths) {
  for (const int reach : {0, 1, 2, 4})
    for (unsigned seed = 1; seed <= 3; ++seed)
      EXPECT_LT(error_of(grid_matrix(14, reach, seed)), rounding) << reach << " " << seed;
}

TEST(ColumnCholeskyTest, SolvesDenseSystems) {
  for (const int side : {1, 2, 3, 5}) EXPECT_LT(error_of(grid_matrix(side, side, 9)), rounding);
}

TEST(ColumnCholeskyTest, AMatrixWithFewerEntriesIsFactoredInTheOrderOfAnother) {
  const Eigen::MatrixXd many = grid_matrix(14, 2, 4), few = grid_matrix(14, 1, 5);
  const auto lower = [](const Eigen::MatrixXd& all) -> Eigen::SparseMatrix<double> {
    return Eigen::MatrixXd(all.triangularView<Eigen::Lower>()).sparseView();
  };
  const ColumnCholesky factor = ColumnCholesky(lower(many)).of_matrix_alike(lower(few));
  const Points3 x = Points3::Random(few.rows(), 3);
  EXPECT_LT((factor.solve(few * x) - x).norm() / x.norm(), rounding);
}

TEST(ColumnCholeskyTest, SystemsThatAreNotPositiveDefiniteAreRefused) {
  Eigen::MatrixXd matrix = grid_matrix(4, 1, 2);
  matrix(5, 5) = -1;
  const Eigen::MatrixXd lower = matrix.triangularView<Eigen::Lower>();
  EXPECT_THROW(ColumnCholesky(lower.sparseView()), Error);
}

}  // namespace
}  // namespace paperbake
