#include "core/step1_elastic/elastic.h"

#include "core/geometry/pattern_mesh.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

using test::hex_sheet;
using test::strip_sheet;

ElasticOptions tight() {
  ElasticOptions options;
  options.stop = 1e-9;
  options.max_iterations = 200;
  return options;
}

std::vector<int> vertices_where(const Sheet& sheet,
                                const std::function<bool(const Vector2d&)>& test) {
  std::vector<int> found;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (test(sheet.pattern.row(v))) found.push_back(v);
  return found;
}

struct Arch {
  double height;  // of the middle, over the length
  double energy;  // over its exact value
};

/// A sheet whose two borders x = 0 and x = L are hinged and approach each other by 10 % in small
/// steps.
Arch elastica(Sheet sheet, double L, double width) {
  const Paper paper;
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 1e-4 * std::sin(M_PI * sheet.pattern(v, 0) / L);
  Elastic elastic(paper, tight());
  elastic.set_mesh(sheet);
  PositionConstraints held = test::held_at(
      vertices_where(sheet, [&](const Vector2d& p) { return p.x() < 1e-9 || p.x() > L - 1e-9; }),
      sheet.x);
  ElasticReport report;
  constexpr int steps = 20;
  // the last steps are at rest, so that no trace of the motion is left
  for (int step = 1; step <= steps + 3; ++step) {
    const double shortening = 0.1 * L * std::min(step, steps) / steps;
    for (PositionConstraint& c : held) {
      const auto p = sheet.pattern.row(c.vertex);
      c.target << (p.x() > 0.5 * L ? p.x() - shortening : p.x()), p.y(), 0;
    }
    report = elastic.step(sheet, {held}, 1 / 24.0);
    EXPECT_TRUE(report.converged);
  }
  double height = 0;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (std::abs(sheet.pattern(v, 0) - 0.5 * L) < 1e-9) height = std::max(height, sheet.x(v, 2));
  return {height / L, report.energy / (1.0126 * paper.bending_stiffness / L * width)};
}

// closed form of the elastica with hinged ends at 10 % shortening: h/L = 0.194924 and U L/D =
// 1.0126 per width
TEST(ElasticTest, ArchOfRulingStripsHasTheHeightAndEnergyOfTheElastica) {
  const struct {
    int strips;
    double height_pct, energy_pct;
  } cases[] = {{8, 0.7, 2}, {16, 0.2, 0.5}, {32, 0.05, 0.2}};
  for (const auto& c : cases) {
    const Arch arch = elastica(strip_sheet(0.1, 0.05, c.strips), 0.1, 0.05);
    EXPECT_NEAR(arch.height / 0.194924, 1, 0.01 * c.height_pct) << c.strips << " strips";
    EXPECT_NEAR(arch.energy, 1, 0.01 * c.energy_pct) << c.strips << " strips";
  }
}

TEST(ElasticTest, ArchOfANearEquilateralMeshConvergesToTheElastica) {
  const Arch arch = elastica(hex_sheet(0.1, 0.05, 20), 0.1, 0.05);
  EXPECT_NEAR(arch.height / 0.194924, 1, 0.003);
  EXPECT_NEAR(arch.energy, 1, 0.01);
}

/// A strip of 16 cells of which the first is clamped: the clamping line lies in its middle, at the
/// distance L from the free end. Beyond the second cell (the first two are the same in all cases,
/// so that all are clamped alike) the cells are near-equilateral triangles in a lattice turned by
/// `angle`; angle < 0: ruling strips.
struct Cantilever {
  Sheet sheet;
  double h, L = 0.1;
};
Cantilever cantilever(double angle) {
  Cantilever c;
  const int cells = 16;
  c.h = c.L / (cells - 0.5);
  const double length = cells * c.h, width = 4 * c.h;
  if (angle < 0) {
    c.sheet = strip_sheet(length, width, cells);
    return c;
  }
  std::vector<Vector2d> clamped;
  for (int j = 0; j <= 8; ++j)
    for (double x : {0.0, c.h, 2 * c.h}) clamped.emplace_back(x, 0.5 * j * c.h);
  PatternMesh mesh = mesh_pattern(test::rectangle(length, width), c.h, clamped, angle);
  c.sheet = test::flat_sheet(std::move(mesh.vertices), std::move(mesh.triangles));
  return c;
}

struct Hang {
  double drop, tip_angle;  // over L; degrees
};
/// lam = rho g L^3/D. nu = 0, because the closed form is for a strip that is free to curl across.
Hang hang(Cantilever c, double lam) {
  Paper paper;
  paper.poisson = 0;
  ElasticOptions options = tight();
  const PositionConstraints held = test::held_at(
      vertices_where(c.sheet, [&](const Vector2d& p) { return p.x() < 1.01 * c.h; }), c.sheet.x);
  constexpr int steps = 16;
  for (int step = 1; step <= steps; ++step) {
    options.forces.gravity =
        lam * paper.bending_stiffness / (paper.area_density * std::pow(c.L, 3)) * step / steps;
    Elastic elastic(paper, options);
    elastic.set_mesh(c.sheet);
    for (int rest = 0; rest < (step == steps ? 4 : 1); ++rest)
      EXPECT_TRUE(elastic.step(c.sheet, {held}, 1.0).converged);
  }
  // position and slope of the free end, from a straight line through its last two cells, where
  // nothing bends
  const double end = 16 * c.h;
  double n = 0, s = 0, ss = 0;
  Eigen::Vector2d p = Eigen::Vector2d::Zero(), sp = p;
  for (int v = 0; v < c.sheet.x.rows(); ++v) {
    const double a = c.sheet.pattern(v, 0) - end;
    if (a < -1.6 * c.h) continue;
    const Eigen::Vector2d q(c.sheet.x(v, 0), c.sheet.x(v, 2));
    n += 1;
    s += a;
    ss += a * a;
    p += q;
    sp += a * q;
  }
  const Eigen::Vector2d slope = (n * sp - s * p) / (n * ss - s * s), tip = (p - slope * s) / n;
  return {-tip.y() / c.L, std::atan2(-slope.y(), slope.x()) * 180 / M_PI};
}

// heavy elastica, clamped horizontally, solved to 5 digits: lam, tip drop/L, tip angle [degrees]
constexpr double heavy[][3] = {{0.5, 0.06231, 4.763}, {1, 0.12347, 9.460},  {2, 0.23851, 18.426},
                               {4, 0.42516, 33.724},  {8, 0.64063, 53.865}, {16, 0.79702, 72.207}};

TEST(ElasticTest, HeavyCantileverHangsAsTheHeavyElastica) {
  const Cantilever strip = cantilever(-1);
  for (const auto& [lam, drop, angle] : heavy) {
    const Hang got = hang(strip, lam);
    EXPECT_NEAR(got.drop / drop, 1, 0.01) << "lam " << lam;
    EXPECT_NEAR(got.tip_angle / angle, 1, 0.01) << "lam " << lam;
  }
}

TEST(ElasticTest, HeavyCantileverDoesNotDependOnTheDirectionOfTheMesh) {
  for (const double lam : {1.0, 8.0}) {
    double least = 1e9, most = 0;
    for (const double degrees : {0.0, 30.0, 45.0}) {
      const double drop = hang(cantilever(degrees * M_PI / 180), lam).drop;
      least = std::min(least, drop);
      most = std::max(most, drop);
    }
    EXPECT_GT(least, 0.05);
    EXPECT_LT(most / least - 1, 0.02) << "lam " << lam;
  }
}

TEST(ElasticTest, FreeSheetFallsWithGravityWhenInertiaIsOn) {
  ElasticOptions options = tight();
  options.forces.gravity = 9.81;
  options.inertia = Inertia::dynamic;
  Sheet sheet = hex_sheet(0.1, 0.1, 4);
  Elastic elastic(Paper{}, options);
  elastic.set_mesh(sheet);
  const double dt = 1e-3;
  for (int k = 0; k < 10; ++k) elastic.step(sheet, {}, dt);
  // backward Euler: z_n = -g dt^2 n(n+1)/2, a little less because of the damping (0.98 per 1/24 s)
  const double fallen = -sheet.x.col(2).mean();
  EXPECT_NEAR(fallen / (9.81 * dt * dt * 55), 1, 0.004);
  EXPECT_LT(sheet.x.col(2).maxCoeff() - sheet.x.col(2).minCoeff(), 1e-9);
}

TEST(ElasticTest, PlasticCurvatureIsTheShapeASheetTakesWhenItIsFree) {
  Sheet sheet = strip_sheet(0.1, 0.03, 20);
  PlasticMemory bent(static_cast<int>(sheet.triangles.rows()));
  bent.curvature.col(0).setConstant(1 / 0.08);
  PlasticGrid grid(test::rectangle(0.1, 0.03));
  grid.write(grid.cover(sheet.pattern, sheet.triangles), bent);
  Elastic elastic(Paper{}, tight());
  elastic.set_plastic_grid(&grid);
  elastic.set_mesh(sheet);
  for (int k = 0; k < 30; ++k) elastic.step(sheet, {}, 1.0);
  // the chord of an arc of 0.1 m with the radius 0.08 m
  const double chord = (sheet.x.row(0) - sheet.x.row(40)).norm();
  EXPECT_NEAR(chord, 2 * 0.08 * std::sin(0.1 / 0.16), 0.01 * 0.1);
  EXPECT_LT(chord, 0.095);
}

TEST(ElasticTest, SettingAMeshWithTheSameVerticesKeepsTheInitialGuess) {
  const auto last_iterations = [](bool set_again) {
    Sheet sheet = strip_sheet(0.1, 0.05, 20);
    for (int v = 0; v < sheet.x.rows(); ++v)
      sheet.x(v, 2) = 0.01 * std::sin(M_PI * sheet.pattern(v, 0) / 0.1);
    ElasticOptions options;
    options.stop = 1e-7;
    Elastic elastic(Paper{}, options);
    elastic.set_mesh(sheet);
    PositionConstraints held = test::held_at({0, 1, 40, 41}, sheet.x);
    int iterations = 0;
    for (int step = 0; step < 12; ++step) {
      const double right = 0.097 - 2e-4 * step;
      for (int k = 0; k < 4; ++k) held[k].target << (k < 2 ? 0 : right), (k % 2 ? 0.05 : 0), 0;
      if (step == 11 && set_again) elastic.set_mesh(sheet);
      iterations = elastic.step(sheet, {held}, 1 / 24.0).iterations;
    }
    return iterations;
  };
  ASSERT_GT(last_iterations(false), 0);
  EXPECT_EQ(last_iterations(true), last_iterations(false));
}

TEST(ElasticTest, StiffenedBendingStoresMoreEnergyByThatFactor) {
  Sheet sheet = strip_sheet(0.1, 0.03, 20);
  test::roll(sheet, 0.1);
  Elastic plain(Paper{}, tight()), true_stiffness(Paper{}, tight());
  plain.set_mesh(sheet);
  true_stiffness.set_mesh(sheet, std::vector<double>(sheet.triangles.rows(), 10.0));
  const auto bending = [&](Elastic& e) {
    return e.evaluate_energies(sheet).energy - e.evaluate_energies(sheet).membrane;
  };
  ASSERT_GT(bending(plain), 1e-5);
  EXPECT_NEAR(bending(true_stiffness) / bending(plain), 10, 1e-9);
}

TEST(ElasticTest, UnfinishedMinimisationIsReportedAndContinuesInLaterSteps) {
  ElasticOptions options = tight();
  options.max_iterations = 1;
  Sheet sheet = hex_sheet(0.1, 0.05, 8);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 0.01 * std::sin(30 * sheet.pattern(v, 0));
  Elastic elastic(Paper{}, options);
  elastic.set_mesh(sheet);
  const PositionConstraints held = test::held_at({0}, sheet.x);
  EXPECT_FALSE(elastic.step(sheet, {held}, 1 / 24.0).converged);
  bool converged = false;
  for (int k = 0; k < 200 && !converged; ++k)
    converged = elastic.step(sheet, {held}, 1 / 24.0).converged;
  EXPECT_TRUE(converged);
}

/// Scene S1 on an interactive mesh: two borders of a sheet of 10 cm approach each other by 10 mm in
/// 24 steps. Then the middle of the front border is carried down by 20 mm in 36 steps, past several
/// snap-throughs, and held there.
struct Snapping {
  Sheet sheet = hex_sheet(0.1, 0.1, 7, 0.1);
  Elastic elastic{Paper{}, {}};
  PositionConstraints held;
  ElasticReport report;
  int steps = 0;

  Snapping() {
    for (int v = 0; v < sheet.x.rows(); ++v)
      sheet.x(v, 2) = 1e-4 * std::sin(M_PI * sheet.pattern(v, 0) / 0.1);
    held = test::held_at(
        vertices_where(sheet, [](const Vector2d& p) { return p.x() < 1e-9 || p.x() > 0.1 - 1e-9; }),
        sheet.x);
    elastic.set_mesh(sheet);
  }
  void step() {
    ++steps;
    if (steps == 25) {
      const int middle = vertices_where(sheet, [](const Vector2d& p) {
                           return p.y() < 1e-9 && std::abs(p.x() - 0.05) < 0.008;
                         }).at(0);
      held.push_back({middle, sheet.x.row(middle)});
    }
    if (steps > 24 && steps <= 60) held.back().target.z() -= 0.02 / 36;
    for (PositionConstraint& c : held)
      if (const auto p = sheet.pattern.row(c.vertex); p.x() < 1e-9 || p.x() > 0.1 - 1e-9)
        c.target << p.x() - (p.x() > 0.05 ? 0.01 * std::min(steps, 24) / 24 : 0), p.y(), 0;
    report = elastic.step(sheet, {held}, 1 / 24.0);
  }
};

TEST(ElasticTest, OnAnInteractiveMeshNoStepWaitsForASnapThrough) {
  Snapping s;
  int most = 0, snap_in_progress = 0;
  for (int k = 0; k < 80; ++k) {
    s.step();
    if (k > 2) {
      most = std::max(most, s.report.iterations);
      snap_in_progress += s.report.snap_in_progress;
    }
  }
  EXPECT_GT(snap_in_progress, 0);  // else nothing has snapped through
  EXPECT_LE(most, 42);
  EXPECT_TRUE(s.report.converged);  // what was left to later steps is finished
  EXPECT_FALSE(s.report.snap_in_progress);
}

TEST(ElasticTest, StepThatIsRolledBackLeavesNoTrace) {
  Snapping s;
  int snaps = 0, other = 0;
  for (int k = 0; k < 60; ++k) {
    const Sheet before = s.sheet;
    const PositionConstraints held = s.held;
    const SolverState state = s.elastic.state();
    s.step();
    const Points3 x = s.sheet.x;
    const ElasticReport report = s.report;
    if (k == 30 || report.snap_in_progress) {
      ++snaps;
      const auto again = [&] {
        s.sheet = before;
        s.held = held;
        --s.steps;
        s.step();
      };
      again();  // with the state after the step that is to be undone
      other += !(s.sheet.x == x);
      s.elastic.restore(state);
      again();
      EXPECT_TRUE(s.sheet.x == x) << k;  // to the last bit
      EXPECT_EQ(s.report.iterations, report.iterations) << k;
    }
  }
  EXPECT_GT(snaps, 1);
  EXPECT_GT(other, 0);  // so the rollback does matter
}

TEST(ElasticTest, ClosingArchTakesFewIterationsPerStep) {
  // plain Newton is held back by the membrane here: the ends of an arch approach each other by 2 mm
  // per step
  ElasticOptions options;
  Sheet sheet = hex_sheet(0.1, 0.05, 10);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 1e-3 * std::sin(M_PI * sheet.pattern(v, 0) / 0.1);
  Elastic elastic(Paper{}, options);
  elastic.set_mesh(sheet);
  PositionConstraints held;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (sheet.pattern(v, 0) < 1e-9 || sheet.pattern(v, 0) > 0.1 - 1e-9)
      held.push_back({v, sheet.x.row(v)});
  for (int step = 0; step < 15; ++step) {
    for (PositionConstraint& c : held) {
      const Vector2d p = sheet.pattern.row(c.vertex);
      c.target << p.x() - (p.x() > 0.05 ? 0.002 * step : 0), p.y(), 0;
    }
    const ElasticReport report = elastic.step(sheet, {held}, 1 / 24.0);
    EXPECT_TRUE(report.converged);
    if (step > 2) {
      EXPECT_LE(report.iterations, 4) << "step " << step;
    }
  }
  EXPECT_GT(sheet.x.col(2).cwiseAbs().maxCoeff(), 0.03);
}

}  // namespace
}  // namespace paperbake
