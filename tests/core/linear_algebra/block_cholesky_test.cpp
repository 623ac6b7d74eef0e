#include "core/linear_algebra/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <random>

namespace paperbake {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

// blocks: under 260 CHOLMOD works column by column, above by supernodes
constexpr int small = 60, large = 300;

/// A random symmetric matrix of 3x3 blocks, kept a second time as a dense matrix.
struct System {
  Pairs coupled;
  Eigen::MatrixXd dense;
  BlockCholesky sparse;
};

/// Each block is coupled to its neighbour and to some others at random, given in either order and
/// some of them twice; the diagonal outweighs its row, so the matrix is positive definite.
System random_system(int blocks, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, blocks - 1);
  Pairs coupled;
  for (int i = 0; i + 1 < blocks; ++i) coupled.emplace_back(i + 1, i);
  for (int k = 0; k < 2 * blocks; ++k) coupled.emplace_back(any(random), any(random));
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * blocks, 3 * blocks);
  BlockCholesky sparse(blocks, coupled);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const auto& [i, j] : coupled) {
    if (i == j) continue;
    Eigen::Matrix3d block;
    for (int k = 0; k < 9; ++k) block.data()[k] = uniform(random);
    dense.block<3, 3>(3 * i, 3 * j) += block;
    dense.block<3, 3>(3 * j, 3 * i) += block.transpose();
    sparse.add(sparse.slot(i, j), block);
  }
  for (int i = 0; i < blocks; ++i) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Constant(0.3);
    for (int c = 0; c < 3; ++c) block(c, c) = 1 + dense.row(3 * i + c).cwiseAbs().sum();
    dense.block<3, 3>(3 * i, 3 * i) = block;
    sparse.add(sparse.slot(i, i), block);
  }
  return {coupled, std::move(dense), std::move(sparse)};
}

/// 1e-12: the systems have condition numbers under 100.
void expect_solves(System& system) {
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(system.dense.rows(), -1, 2);
  const Eigen::VectorXd expected = system.dense.ldlt().solve(b);
  ASSERT_GT(expected.norm(), 0.01);
  EXPECT_LT((system.sparse.solve(b) - expected).norm(), 1e-12 * expected.norm());
}

TEST(BlockCholeskyTest, HoldsTheMatrixThatWasAddedUp) {
  for (const int blocks : {1, 2, small, large}) {
    const System system = random_system(blocks, blocks);
    EXPECT_LT((system.sparse.dense() - system.dense).norm(), 1e-13 * system.dense.norm())
        << blocks << " blocks";
  }
}

TEST(BlockCholeskyTest, SolvesAsADenseMatrixDoes) {
  for (const int blocks : {1, 2, 7, small, 259, 260, large}) {
    System system = random_system(blocks, blocks);
    ASSERT_TRUE(system.sparse.factorise()) << blocks << " blocks";
    expect_solves(system);
  }
}

TEST(BlockCholeskyTest, KeepsItsOrderWhenTheValuesChange) {
  for (const int blocks : {small, large}) {
    System system = random_system(blocks, 1);
    ASSERT_TRUE(system.sparse.factorise());
    system.sparse.set_zero();
    EXPECT_EQ(system.sparse.dense().norm(), 0);
    for (int i = 0; i < blocks; ++i)
      for (int j = 0; j <= i; ++j)
        system.sparse.add(system.sparse.slot(i, j), 2 * system.dense.block<3, 3>(3 * i, 3 * j));
    system.dense *= 2;
    ASSERT_TRUE(system.sparse.factorise());
    expect_solves(system);
  }
}

TEST(BlockCholeskyTest, RefusesAnIndefiniteMatrixUntilItsDiagonalIsShifted) {
  for (const int blocks : {1, small, large}) {
    System system = random_system(blocks, 5);
    const int bad = blocks / 2;
    const Eigen::Matrix3d dent = -40 * Eigen::Vector3d::UnitY() * Eigen::RowVector3d::UnitY();
    system.sparse.add(system.sparse.slot(bad, bad), dent);
    system.dense.block<3, 3>(3 * bad, 3 * bad) += dent;
    ASSERT_LT(system.dense(3 * bad + 1, 3 * bad + 1), 0);
    EXPECT_FALSE(system.sparse.factorise()) << blocks << " blocks";
    EXPECT_FALSE(system.sparse.factorise()) << "asked twice, " << blocks << " blocks";
    system.sparse.shift_diagonal(60);
    system.dense.diagonal().array() += 60;
    ASSERT_TRUE(system.sparse.factorise()) << blocks << " blocks";
    expect_solves(system);
  }
}

TEST(BlockCholeskyTest, ShiftsEveryDiagonalEntryAndNothingElse) {
  System system = random_system(small, 8);
  const Eigen::MatrixXd before = system.sparse.dense();
  system.sparse.shift_diagonal(0.25);
  const Eigen::MatrixXd change = system.sparse.dense() - before;
  EXPECT_LT((change - 0.25 * Eigen::MatrixXd::Identity(3 * small, 3 * small)).norm(), 1e-12);
}

TEST(BlockCholeskyTest, ABlockAboveTheDiagonalIsTheMirrorImageOfTheOneBelow) {
  BlockCholesky one(3, {{0, 1}, {1, 2}}), other(3, {{1, 0}, {2, 1}});
  Eigen::Matrix3d block;
  block << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  for (const auto& [i, j] : Pairs{{0, 1}, {1, 2}}) {
    one.add(one.slot(i, j), block);
    other.add(other.slot(j, i), block.transpose());
    const Eigen::MatrixXd dense = one.dense();
    EXPECT_EQ((dense.block<3, 3>(3 * i, 3 * j)), block);
    EXPECT_EQ((dense.block<3, 3>(3 * j, 3 * i)), block.transpose());
  }
  EXPECT_EQ(one.dense(), other.dense());
}

TEST(BlockCholeskyTest, AnUncoupledPairHasNoPlaceAndWhatIsAddedThereIsPassedBy) {
  BlockCholesky matrix(4, {{0, 1}, {1, 2}, {2, 3}});
  for (const auto& [i, j] : Pairs{{0, 2}, {2, 0}, {0, 3}, {3, 1}, {-1, 0}, {0, -1}, {-1, -1}}) {
    EXPECT_EQ(matrix.slot(i, j).offset, -1) << i << ' ' << j;
    matrix.add(matrix.slot(i, j), Eigen::Matrix3d::Ones());
  }
  EXPECT_EQ(matrix.dense().norm(), 0);
  EXPECT_GE(matrix.slot(2, 1).offset, 0);
  EXPECT_GE(matrix.slot(3, 3).offset, 0);
}

TEST(BlockCholeskyTest, GivesTheSameBitsTwice) {
  for (const int blocks : {small, large}) {
    System one = random_system(blocks, 2), two = random_system(blocks, 2);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * blocks, -1, 2);
    ASSERT_TRUE(one.sparse.factorise() && two.sparse.factorise());
    EXPECT_EQ(one.sparse.solve(b), two.sparse.solve(b));
  }
}

}  // namespace
}  // namespace paperbake
