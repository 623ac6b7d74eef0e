#include "core/step1_elastic/solver/newton.h"

#include "core/geometry/measure.h"
#include "core/step1_elastic/energy_not_finite.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <vector>

namespace paperbake {
namespace {

constexpr double stop = 1e-9;  // [m]

/// A sheet of which some vertices are held, and the system that Newton's method solves for the
/// others.
struct Held {
  Sheet sheet;
  Paper paper;
  ElasticEnergy energy;
  Eigen::VectorXd mass;
  std::vector<int> block_of;
  std::optional<BlockCholesky> matrix;
  std::optional<IncrementalPotential> W;

  Held(Sheet of, const std::set<int>& held) : sheet(of), energy(paper, of.pattern, of.triangles) {
    const int n = static_cast<int>(sheet.x.rows());
    mass = Eigen::VectorXd::Zero(n);
    int blocks = 0;
    for (int v = 0; v < n; ++v) block_of.push_back(held.count(v) ? -1 : blocks++);
    std::vector<std::pair<int, int>> coupled;
    for (const auto& [a, b] : energy.coupled_vertices())
      if (block_of[a] >= 0 && block_of[b] >= 0) coupled.emplace_back(block_of[a], block_of[b]);
    matrix.emplace(blocks, coupled);
    energy.bind(*matrix, block_of);
    SheetPotential potential{energy, mass, block_of};
    potential.xhat = sheet.x;
    W.emplace(IncrementalPotential{{potential}, nullptr});
  }
  Held(const Held&) = delete;  // W refers to its other parts

  NewtonReport minimise_from(Points3& x, const NewtonOptions& options) {
    return minimise({*W, *matrix, block_of, 0.01, paper.membrane_stiffness}, options,
                    energy.stress(x, Points3::Zero(x.rows(), 3)), x);
  }
  /// [N] Largest force on a free vertex.
  double force(const Points3& x) {
    Points3 gradient;
    W->differentiate(x, HessianForm::exact, gradient, *matrix);
    for (std::size_t v = 0; v < block_of.size(); ++v)
      if (block_of[v] < 0) gradient.row(v).setZero();
    return max_row_norm(gradient);
  }
};

NewtonOptions by(NewtonOptions::Ways ways, int most = 200) {
  NewtonOptions options{stop, most, most};
  options.ways = ways;
  return options;
}

/// Numbers of the vertices within 15 mm of the border x = 0.
std::set<int> at_the_left(const Sheet& sheet) {
  std::set<int> held;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (sheet.pattern(v, 0) < 0.015) held.insert(v);
  return held;
}

/// The sheet out of its rest: waves of this height. [m]
Points3 wavy(const Sheet& sheet, const std::set<int>& held, double height) {
  Points3 x = sheet.x;
  for (int v = 0; v < x.rows(); ++v)
    if (!held.count(v)) x(v, 2) += height * std::sin(60 * x(v, 0)) * std::cos(40 * x(v, 1));
  return x;
}

TEST(NewtonTest, ASheetThatIsClampedAtABorderGoesFlatByBothWays) {
  const Sheet flat = test::hex_sheet(0.1, 0.06, 8, 0.2);
  const std::set<int> left = at_the_left(flat);
  for (const auto ways :
       {NewtonOptions::both, NewtonOptions::mixed_newton, NewtonOptions::line_search_newton}) {
    Held held(flat, left);
    Points3 x = wavy(flat, left, 5e-4);
    ASSERT_GT((*held.W)(x), 1e-6);
    const NewtonReport report = held.minimise_from(x, by(ways));
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.descended, ways == NewtonOptions::line_search_newton);
    EXPECT_GT(report.iterations, 2);
    EXPECT_LT(max_row_norm(x - flat.x), 10 * stop);
    for (const int v : left) EXPECT_EQ(x.row(v), flat.x.row(v)) << "held";
  }
}

TEST(NewtonTest, ALoadAtTheEndOfACantileverBendsItAsABeam) {
  // w = F l^3 / (3 D b) where it is small; the clamp ends in the middle of the cell that is held
  constexpr double cell = 0.001, length = 0.06, width = 0.01, force = 1e-6;
  const Sheet flat = test::strip_sheet(length + cell, width, 61);
  Held held(flat, {0, 1, 2, 3});
  held.mass.tail(2).setConstant(0.5 * force);
  held.W->sheets.front().forces = {1.0};  // [m/s2]
  const double sag =
      force * std::pow(length + cell / 2, 3) / (3 * Paper{}.bending_stiffness * width);
  for (const auto ways : {NewtonOptions::mixed_newton, NewtonOptions::line_search_newton}) {
    Points3 x = flat.x;
    EXPECT_TRUE(held.minimise_from(x, by(ways)).converged);
    EXPECT_NEAR(-x.bottomRows(2).col(2).mean(), sag, 1e-3 * sag);
  }
}

/// A sheet between two borders that are held 5 mm nearer to each other, which has to arch.
struct Arch : Held {
  Arch() : Held(test::hex_sheet(0.1, 0.06, 8, 0.2), ends()) {}
  static std::set<int> ends() {
    const Sheet flat = test::hex_sheet(0.1, 0.06, 8, 0.2);
    std::set<int> ends = at_the_left(flat);
    for (int v = 0; v < flat.x.rows(); ++v)
      if (flat.pattern(v, 0) > 0.085) ends.insert(v);
    return ends;
  }
  /// The sheet pushed together evenly, with a slight arch.
  Points3 start() const {
    Points3 x = sheet.x;
    for (int v = 0; v < x.rows(); ++v) {
      const double share = std::clamp((x(v, 0) - 0.0125) / 0.075, 0.0, 1.0);
      x(v, 0) -= 0.005 * (sheet.pattern(v, 0) > 0.085 ? 1 : block_of[v] < 0 ? 0 : share);
      if (block_of[v] >= 0) x(v, 2) += 0.012 * std::pow(std::sin(M_PI * share), 2);
    }
    return x;
  }
};

TEST(NewtonTest, BothWaysEndWhereNoForceIsLeftAndNoSmallMoveLowersTheEnergy) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const auto ways : {NewtonOptions::both, NewtonOptions::line_search_newton}) {
    Arch arch;
    const Points3 start = arch.start();
    ASSERT_GT(arch.force(start), 1);
    Points3 x = start;
    EXPECT_TRUE(arch.minimise_from(x, by(ways)).converged);
    EXPECT_LT(arch.force(x), 1e-6);
    EXPECT_GT(x.col(2).maxCoeff(), 0.005) << "it arches";
    const double least = (*arch.W)(x);
    for (int k = 0; k < 50; ++k) {
      Points3 other = x;
      for (int v = 0; v < x.rows(); ++v)
        for (int i = 0; i < 3; ++i) other(v, i) += arch.block_of[v] < 0 ? 0 : 1e-6 * normal(random);
      EXPECT_GT((*arch.W)(other), least);
    }
  }
}

TEST(NewtonTest, LineSearchNewtonOnlyDescends) {
  // from a crumpled start, where whole steps overshoot
  Arch arch;
  const Points3 start = wavy({arch.sheet.pattern, arch.start(), {}, {}, {}}, Arch::ends(), 2e-3);
  double last = (*arch.W)(start);
  for (int iterations = 1; iterations < 20; ++iterations) {
    Points3 x = start;
    arch.minimise_from(x, by(NewtonOptions::line_search_newton, iterations));
    const double value = (*arch.W)(x);
    EXPECT_LT(value, last) << iterations;
    last = value;
  }
}

TEST(NewtonTest, OneIterationMovesNoVertexFartherThanTwoEdges) {
  Held held(test::strip_sheet(0.1, 0.02, 10), {0, 1, 2, 3});
  held.mass.tail(2).setConstant(1);
  held.W->sheets.front().forces = {9.81};  // a kilogram hangs on it, and a beam would sag for miles
  for (const auto ways : {NewtonOptions::mixed_newton, NewtonOptions::line_search_newton}) {
    Points3 x = held.sheet.x;
    NewtonOptions options = by(ways, 1000);
    int asked = 0;
    Points3 at;
    options.should_abort = [&](const Points3& now) { return at = now, ++asked > 0; };
    held.minimise_from(x, options);
    ASSERT_EQ(asked, 1) << "after four iterations";
    EXPECT_LT(max_row_norm(at - held.sheet.x), 4 * 2 * 0.01 + 1e-9);
    EXPECT_GT(max_row_norm(at - held.sheet.x), 2 * 0.01);
  }
}

TEST(NewtonTest, EndsWhenItIsAskedTo) {
  Arch arch;
  for (const auto ways : {NewtonOptions::both, NewtonOptions::line_search_newton}) {
    Points3 x = arch.start();
    NewtonOptions options = by(ways);
    options.max_mixed_newton = 6;  // too few
    Points3 last = x;
    int asked = 0;
    options.should_abort = [&](const Points3& now) { return last = now, ++asked > 0; };
    const NewtonReport report = arch.minimise_from(x, options);
    EXPECT_TRUE(report.aborted);
    EXPECT_TRUE(report.descended) << "only the last variant asks";
    EXPECT_EQ(asked, 1);
    EXPECT_FALSE(report.converged);
    EXPECT_TRUE(same_entries(x, last));
    EXPECT_LT(report.iterations, 6 + 6);
  }
}

TEST(NewtonTest, KeepsToTheNumberOfIterations) {
  for (const int most : {1, 5}) {
    Arch arch;
    Points3 x = arch.start();
    const NewtonReport report = arch.minimise_from(x, by(NewtonOptions::line_search_newton, most));
    EXPECT_EQ(report.iterations, most);
    EXPECT_FALSE(report.converged);
    EXPECT_LT((*arch.W)(x), (*arch.W)(arch.start()));
  }
  Arch arch;
  Points3 x = arch.start();
  NewtonOptions options = by(NewtonOptions::both);
  options.max_mixed_newton = 2;
  const NewtonReport report = arch.minimise_from(x, options);
  EXPECT_TRUE(report.descended) << "the other variant goes on";
  EXPECT_TRUE(report.converged);
  EXPECT_GT(report.iterations, 4);
}

TEST(NewtonTest, MixedNewtonAloneLeavesTheSheetWhereItIsIfItDoesNotConverge) {
  Arch arch;
  Points3 x = arch.start();
  const NewtonReport report = arch.minimise_from(x, by(NewtonOptions::mixed_newton, 2));
  EXPECT_FALSE(report.converged);
  EXPECT_FALSE(report.descended);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_EQ(x, arch.start());
}

TEST(NewtonTest, AnEnergyThatIsNotFiniteIsTold) {
  Arch arch;
  for (const auto ways : {NewtonOptions::mixed_newton, NewtonOptions::line_search_newton}) {
    Points3 x = arch.start();
    x(x.rows() / 2, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(arch.minimise_from(x, by(ways)), EnergyNotFinite);
  }
}

}  // namespace
}  // namespace paperbake
