// Every grade makes a d-cone as paper does, and droops under its own weight as it should.

#include "formats/cache/alembic_reader.h"
#include "formats/config/preset_file.h"
#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace paperbake {
namespace {

using test::read;

class GradesTest : public test::CommandLine, public testing::WithParamInterface<std::string> {};

TEST_P(GradesTest, EveryGradeMakesADConeWithoutStretching) {
  const test::Ended ended =
      run({"bake", test::samples + "/S8_dcone.glb", "-o", output(), "--preset", GetParam(),
           "--formats", "cert", "--mesh", "simulation", "--progress", "none"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto summary =
      nlohmann::json::parse(read(test::fs::path(output()) / "cert" / "summary.json"));
  EXPECT_EQ(summary["sheets"][0]["preset"], GetParam());
  EXPECT_LT(summary["stretch_mean_pct"]["max"], 0.1);  // worst of the thirteen: card300, 0.02
  EXPECT_LT(summary["stretch_max_pct"]["max"], 1);
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, GradesTest, testing::ValuesIn(preset_names()),
                         [](const auto& grade) { return grade.param; });

/// Drop of the tip, over the length L, of a strip that is clamped level and droops by its weight:
///
///   psi'' = lam u sin(psi),  psi'(0) = 0,  psi(1) = pi/2
///
/// u    [1] from the free end, in lengths
/// psi  [rad] between strip and plumb line
/// lam  [1] = density g L^3 / stiffness
///
/// Of the solutions that turn by a right angle the one with the least psi(0) does not coil.
double heavy_elastica(double lam) {
  struct End {
    double psi, drop;
  };
  const auto shoot = [&](double least) {  // classical Runge-Kutta
    constexpr int steps = 1000;
    constexpr double h = 1.0 / steps;
    using State = std::array<double, 3>;  // psi, psi', drop
    const auto change = [&](double u, const State& y) {
      return State{y[1], lam * u * std::sin(y[0]), std::cos(y[0])};
    };
    const auto moved = [](State y, double by, const State& k) {
      for (int i = 0; i < 3; ++i) y[i] += by * k[i];
      return y;
    };
    State y{least, 0, 0};
    for (int step = 0; step < steps && y[0] <= M_PI / 2; ++step) {
      const double u = step * h;
      const State a = change(u, y), b = change(u + h / 2, moved(y, h / 2, a)),
                  c = change(u + h / 2, moved(y, h / 2, b)), d = change(u + h, moved(y, h, c));
      for (const auto& [share, k] : {std::pair{1, a}, {2, b}, {2, c}, {1, d}})
        y = moved(y, share * h / 6, k);
    }
    return End{y[0], y[2]};
  };
  double low = -50, high = std::log(M_PI / 2);  // of log psi(0)
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (low + high) / 2;
    (shoot(std::exp(middle)).psi > M_PI / 2 ? high : low) = middle;
  }
  return shoot(std::exp(low)).drop;
}

class DroopTest : public test::CommandLine {
 protected:
  /// Expects every strip of G4_grades to droop as the elastica of its grade.
  /// error  [1] of the drop that is allowed
  void expect_elastica(const test::Words& options, double error) {
    constexpr double length = 0.18, gravity = 9.81;  // [m] beyond the first 2 cm, which are held
    test::Words words{"bake",       test::samples + "/G4_grades.glb",
                      "-o",         output(),
                      "--mesh",     "simulation",
                      "--formats",  "abc",
                      "--frames",   "1-24",
                      "--progress", "none"};
    words.insert(words.end(), options.begin(), options.end());
    const test::Ended ended = run(words);
    ASSERT_EQ(ended.code, 0) << ended.err;
    const AlembicReader cache(output() + "/G4_grades.abc");
    ASSERT_EQ(cache.sheets().size(), 6u);
    for (std::size_t sheet = 0; sheet < 6; ++sheet) {
      const std::string name = cache.sheets()[sheet].name, grade = name.substr(name.find('_') + 1);
      const Paper paper = read_preset(grade).paper;
      // a strip is free to curl crosswise, so it bends more easily than a wide sheet
      const double stiffness = paper.bending_stiffness * (1 - paper.poisson * paper.poisson);
      const double drop =
          heavy_elastica(paper.area_density * gravity * std::pow(length, 3) / stiffness);
      const Points3 x = cache.frame(sheet, 23).x;
      EXPECT_NEAR(-x.col(2).minCoeff() / length / drop, 1, error) << grade;
    }
  }
};

TEST_F(DroopTest, TheReferenceHasTheValuesOfTheLiterature) {
  EXPECT_NEAR(heavy_elastica(0.5), 0.06231, 1e-5);
  EXPECT_NEAR(heavy_elastica(8), 0.64063, 1e-5);
  EXPECT_NEAR(heavy_elastica(32), 0.87846, 1e-5);
  // in a limp strip tension takes the place of stiffness: 1 - drop tends to (2 - sqrt 2) / sqrt lam
  EXPECT_NEAR((1 - heavy_elastica(4000)) * std::sqrt(4000), 2 - std::sqrt(2), 0.01);
}

TEST_F(DroopTest, StripsOfSixGradesDroopAsTheElastica) { expect_elastica({}, 0.08); }

TEST_F(DroopTest, StripsOfFineFiniteElementsDroopAsTheElastica) {
  expect_elastica({"--method", "fem", "--triangles", "2000"}, 0.03);
}

}  // namespace
}  // namespace paperbake
