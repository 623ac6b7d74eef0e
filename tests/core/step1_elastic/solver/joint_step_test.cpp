// Joint steps: several sheets in one step of step 1.

#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/step1_elastic/elastic.h"
#include "core/step1_elastic/solver/incremental_potential.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace paperbake {
namespace {

constexpr double dt = 1 / 24.0;

/// Two sheets of different paper and mesh, one over the other and closer than dhat, both bent and
/// not at rest; and the potential of a step of both.
struct TwoLayers {
  Sheet low = test::hex_sheet(0.1, 0.1, 6, 0.2, 1), high = test::hex_sheet(0.08, 0.08, 5, 0.2, 2);
  Paper stiff;
  std::optional<ElasticEnergy> of_low, of_high;
  Eigen::VectorXd mass_low, mass_high;
  std::vector<int> blocks, blocks_low, blocks_high;
  std::optional<SheetContact> contact;
  Points3 x, xhat;
  std::vector<std::pair<int, int>> coupled;

  TwoLayers() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> noise(-1e-4, 1e-4);
    high.x.col(2).array() += 6e-4;
    for (Sheet* s : {&low, &high})
      for (int v = 0; v < s->x.rows(); ++v)
        s->x.row(v) += Eigen::RowVector3d(0.1 * noise(random), 0.1 * noise(random), noise(random));
    stiff.bending_stiffness *= 5;
    stiff.membrane_stiffness *= 2;
    of_low.emplace(Paper{}, low.pattern, low.triangles);
    of_high.emplace(stiff, high.pattern, high.triangles);
    const int n = static_cast<int>(low.x.rows()), m = static_cast<int>(high.x.rows());
    mass_low = Eigen::VectorXd::Constant(n, 1e-5);
    mass_high = Eigen::VectorXd::Constant(m, 3e-5);
    Points2 pattern(n + m, 2);
    // they overlap on the pattern, but features of two sheets are not neighbours because of that
    pattern << low.pattern, high.pattern;
    Triangles triangles(low.triangles.rows() + high.triangles.rows(), 3);
    triangles << low.triangles, (high.triangles.array() + n).matrix();
    SheetPartition sheets{std::vector<int>(n, 0), Eigen::MatrixXd::Constant(2, 2, 1e-3)};
    sheets.of_vertex.resize(n + m, 1);
    contact.emplace(pattern, triangles, sheets);
    x.resize(n + m, 3);
    x << low.x, high.x;
    xhat = x.array() + 1e-3;
    blocks.resize(n + m);
    std::iota(blocks.begin(), blocks.end(), 0);
    blocks_low.assign(blocks.begin(), blocks.begin() + n);
    blocks_high.assign(blocks.begin() + n, blocks.end());
    for (int i = 0; i < n + m; ++i)
      for (int j = 0; j < i; ++j) coupled.emplace_back(i, j);
  }

  IncrementalPotential potential(SheetContact* felt) {
    const int n = static_cast<int>(low.x.rows());
    SheetPotential of_first{*of_low, mass_low, blocks_low};
    of_first.xhat = xhat.topRows(n);
    of_first.inertia = 5e4;
    of_first.forces = {9.81};
    of_first.springs = {{3, {0, 0, 0.01}, 20}};
    SheetPotential of_second{*of_high, mass_high, blocks_high};
    of_second.xhat = xhat.bottomRows(high.x.rows());
    of_second.inertia = 2e4;
    of_second.forces = {9.81};
    of_second.springs = {{1, {0, 0.01, 0}}};
    return {{of_first, of_second}, felt};
  }
};

TEST(JointStepTest, DerivativesOfThePotentialOfTwoSheetsMatchItsValue) {
  TwoLayers two;
  two.contact->begin(two.x, {});
  ASSERT_GT(two.contact->touching_by_sheet(two.x)[0].others, 100);
  BlockCholesky matrix(static_cast<int>(two.x.rows()), two.coupled);
  two.of_low->bind(matrix, two.blocks_low);
  two.of_high->bind(matrix, two.blocks_high);
  two.contact->bind(matrix, two.blocks);
  const IncrementalPotential W = two.potential(&*two.contact), apart = two.potential(nullptr);
  Points3 gradient, unused, before, after;
  EXPECT_NEAR(W.differentiate(two.x, HessianForm::exact, gradient, matrix), W(two.x),
              1e-12 * std::abs(W(two.x)));
  EXPECT_GT(W(two.x), apart(two.x) + 1e-6);
  ASSERT_GT(gradient.norm(), 1);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 6; ++k) {
    Points3 way = Points3::Zero(two.x.rows(), 3);
    for (int i = 0; i < way.size(); ++i) way.data()[i] = normal(random);
    const double step = 1e-9;
    EXPECT_NEAR((W(two.x + step * way) - W(two.x - step * way)) / (2 * step),
                gradient.cwiseProduct(way).sum(), 1e-5 * gradient.norm());
  }
  // the Hessian of contact is cut so that it is never indefinite; without contact the matrix is
  // exact, and nothing couples the two sheets
  apart.differentiate(two.x, HessianForm::exact, unused, matrix);
  const Eigen::MatrixXd second = matrix.dense();
  const auto n = 3 * two.low.x.rows();
  EXPECT_EQ(second.topRightCorner(n, second.cols() - n).norm(), 0);
  Points3 way(two.x.rows(), 3);
  for (int i = 0; i < way.size(); ++i) way.data()[i] = normal(random);
  const double step = 1e-8;
  apart.differentiate(two.x - step * way, HessianForm::exact, before, matrix);
  apart.differentiate(two.x + step * way, HessianForm::exact, after, matrix);
  const Points3 change = (after - before) / (2 * step);
  const Eigen::VectorXd told = second * Eigen::Map<const Eigen::VectorXd>(way.data(), way.size());
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(change.data(), change.size()) - told).norm(),
            1e-5 * told.norm());
}

TEST(JointStepTest, ContactForcesAndTorquesBetweenTwoSheetsCancel) {
  TwoLayers two;
  two.contact->begin(two.x, {});
  Points3 force = Points3::Zero(two.x.rows(), 3);
  two.contact->differentiate(two.x, force, nullptr);
  const auto n = two.low.x.rows();
  ASSERT_GT(force.topRows(n).colwise().sum().norm(), 1e-2);
  EXPECT_LT(force.colwise().sum().norm(), 1e-12 * force.norm());
  Eigen::RowVector3d turn = Eigen::RowVector3d::Zero();
  for (int v = 0; v < two.x.rows(); ++v) turn += two.x.row(v).cross(force.row(v));
  EXPECT_LT(turn.norm(), 1e-12 * force.norm());
}

/// Two free sheets, one over the other; the lower one flies up.
TEST(JointStepTest, AFreeSheetThatRunsIntoAnotherPassesItsMomentumOn) {
  Sheet low = test::hex_sheet(0.1, 0.1, 6, 0.2, 1), high = test::hex_sheet(0.08, 0.08, 5, 0.2, 2);
  high.x.rowwise() += Eigen::RowVector3d(0.01, 0.01, 3e-3);
  ElasticOptions options;
  options.inertia = Inertia::dynamic;
  options.stop = 1e-8;
  Elastic of_low({}, options), of_high({}, options);
  of_low.set_mesh(low);
  of_high.set_mesh(high);
  const double speed = 0.1;  // [m/s] enough to pass through it in one step of 1/96 s
  low.v.col(2).setConstant(speed);
  const StepInput none;
  const Points3 nowhere(0, 3);
  const Eigen::MatrixXd dhat = Eigen::MatrixXd::Constant(2, 2, 1e-3);
  const auto momentum = [&](const Sheet& s) {
    double sum = 0;
    for (int t = 0; t < s.triangles.rows(); ++t)
      for (const int v : s.triangles.row(t))
        sum += Paper{}.area_density * rest_triangle(s.pattern, s.triangles.row(t)).area / 3 *
               s.v(v, 2);
    return sum;
  };
  const double begun = momentum(low);
  double lost = 1;
  int touching = 0;
  for (int k = 0; k < 12; ++k) {
    const std::vector<ElasticReport> reports = Elastic::step_together(
        {{of_low, low, none, nowhere}, {of_high, high, none, nowhere}}, dhat, 1 / 96.0);
    touching = std::max(touching, reports[0].touching_others);
    EXPECT_EQ(reports[0].touching_others, reports[1].touching_others);
    EXPECT_EQ(crossings_between(low, high), 0);
    lost *= std::pow(0.98, 24 / 96.0);  // damping of the velocity
  }
  EXPECT_GT(touching, 0);
  EXPECT_GT(momentum(high), 0.2 * begun);
  // part of the impact is left unfinished after 40 iterations
  EXPECT_NEAR((momentum(low) + momentum(high)) / (begun * lost), 1, 0.04);
}

TEST(JointStepTest, CollisionFreeUntilASheetPassesThroughTheOtherOrEndsCloseToIt) {
  Sheet low = test::hex_sheet(0.1, 0.1, 6, 0.2, 1), high = test::hex_sheet(0.08, 0.08, 5, 0.2, 2);
  high.x.col(2).array() += 0.01;
  const PositionConstraints none;
  const Points3 nowhere(0, 3);
  const auto clear = [&](const std::vector<double>& heights) {
    std::vector<Points3> stays(heights.size(), low.x), goes;
    for (const double z : heights) {
      goes.push_back(high.x);
      goes.back().col(2).setConstant(z);
    }
    return Elastic::are_collision_free({low, none, stays, nowhere}, {high, none, goes, nowhere},
                                       2e-3);
  };
  EXPECT_TRUE(clear({0.01, 0.003}));
  EXPECT_FALSE(clear({0.01, 0.0015}));
  EXPECT_FALSE(clear({0.01, -0.01}));
  EXPECT_TRUE(clear({0.01, 0.004, 0.02}));
  EXPECT_FALSE(clear({0.01, 0.001, 0.02})) << "near it on its way";
}

}  // namespace
}  // namespace paperbake
