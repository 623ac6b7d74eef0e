#include "core/step1_elastic/energies/apex_stiffness.h"
#include "core/model/segment2.h"

#include "core/geometry/pattern_mesh.h"
#include "core/step1_elastic/elastic.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "tests/core/test_cones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace paperbake {
namespace {

constexpr double R = 0.05;   // [m] of the discs
constexpr double eps = 0.1;  // slope of the cones

/// Two crests and two valleys: smooth enough for a few rulings.
double saddle(double t) { return std::cos(2 * t); }

/// A disc with rings of `rulings` vertices around the origin, where a singular point is.
/// jitter  [1] of the angle between rulings, and of the radii of the rings
Sheet disc(int rulings, const std::vector<double>& rings, double jitter = 0) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  Points2 p(1 + rings.size() * rulings, 2);
  Triangles t((2 * rings.size() - 1) * rulings, 3);
  const auto at = [&](int ring, int k) { return 1 + ring * rulings + k % rulings; };
  std::vector<double> angle;
  for (int k = 0; k < rulings; ++k) angle.push_back(2 * M_PI * (k + uniform(random)) / rulings);
  p.row(0).setZero();
  int next = 0;
  for (int ring = 0; ring < static_cast<int>(rings.size()); ++ring)
    for (int k = 0; k < rulings; ++k) {
      const bool border = ring + 1 == static_cast<int>(rings.size());
      const double r = rings[ring] * (1 + (border ? 0 : uniform(random)));
      p.row(at(ring, k)) << r * std::cos(angle[k]), r * std::sin(angle[k]);
      if (ring == 0) {
        t.row(next++) << 0, at(0, k), at(0, k + 1);
        continue;
      }
      t.row(next++) << at(ring - 1, k), at(ring, k), at(ring, k + 1);
      t.row(next++) << at(ring - 1, k), at(ring, k + 1), at(ring - 1, k + 1);
    }
  Sheet sheet = test::flat_sheet(std::move(p), std::move(t));
  sheet.singular.push_back({Vector2d(0, 0), 1, ""});
  return sheet;
}

/// Radii of rings from `first` out to R, each at most 1.6 times as large as the one before.
std::vector<double> rings_from(double first) {
  const int steps = static_cast<int>(std::ceil(std::log(R / first) / std::log(1.6)));
  std::vector<double> rings;
  for (int k = 0; k <= steps; ++k) rings.push_back(first * std::pow(R / first, double(k) / steps));
  return rings;
}

/// A near-equilateral mesh of a round disc, as the tool makes it, with a vertex at the singular
/// point.
Sheet any_mesh(double edge) {
  Pattern pattern;
  constexpr int sides = 96;
  for (int k = 0; k < sides; ++k)
    pattern.outline.push_back(Vector2d(R, R) + R * Vector2d(std::cos(2 * M_PI * k / sides),
                                                            std::sin(2 * M_PI * k / sides)));
  PatternMesh mesh = mesh_pattern(pattern, edge, {Vector2d(R, R)});
  mesh.vertices.rowwise() -= Eigen::RowVector2d(R, R);
  Sheet sheet = test::flat_sheet(std::move(mesh.vertices), std::move(mesh.triangles));
  sheet.singular.push_back({Vector2d(0, 0), 1, ""});
  return sheet;
}

/// Bending energy over D/2 int kg^2 ln(R/r_c). squared: int kg^2
double ratio(const Sheet& sheet, double squared, const std::vector<double>& factors) {
  const ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles, factors);
  return energy.parts(sheet.x).bending /
         (0.5 * Paper{}.bending_stiffness * squared * std::log(R / core_radius(Paper{}, R)));
}

/// The ratio for a right cone so gentle that its excess angle does not matter: any small number of
/// rulings shows all of its curvature.
double gentle(Sheet sheet, bool with_logarithm = true) {
  constexpr double slope = 0.01;
  sheet.x.col(2) = slope * sheet.pattern.rowwise().norm();
  return ratio(sheet, 2 * M_PI * slope * slope,
               with_logarithm ? apex_stiffness_factors(sheet, Paper{}) : std::vector<double>{});
}

/// The ratio for a cone with two crests, which does not stretch.
double wavy(Sheet sheet) {
  const double squared = test::bend_to_wavy_cone(sheet, eps, saddle);
  return ratio(sheet, squared, apex_stiffness_factors(sheet, Paper{}));
}

TEST(ApexStiffnessTest, AConeHasItsExactEnergyHoweverFarOutTheFirstRingIs) {
  for (const double first : {0.003, 0.005, 0.01, 0.02, 0.04})
    EXPECT_NEAR(gentle(disc(32, rings_from(first))), 1, 0.03) << first;
  // with the shape operator alone, every further ring adds to the energy
  EXPECT_GT(gentle(disc(32, rings_from(0.003)), false),
            gentle(disc(32, rings_from(0.04)), false) + 0.6);
}

TEST(ApexStiffnessTest, TwiceAsManyRulingsChangeTheEnergyByLessThanFivePercent) {
  EXPECT_NEAR(gentle(disc(8, rings_from(0.01))), 1, 0.12);  // sectors of 45 degrees
  for (const int rulings : {12, 24, 48})
    EXPECT_NEAR(
        gentle(disc(2 * rulings, rings_from(0.01))) / gentle(disc(rulings, rings_from(0.01))), 1,
        0.05)
        << rulings;
  // a wave of 180 degrees, averaged over pairs of rulings
  EXPECT_NEAR(wavy(disc(48, rings_from(0.01))), 1, 0.03);
  EXPECT_NEAR(wavy(disc(96, rings_from(0.01))), 1, 0.02);
}

TEST(ApexStiffnessTest, IrregularFansHaveTheSameEnergy) {
  for (const int rulings : {12, 24, 48})
    EXPECT_NEAR(gentle(disc(rulings, rings_from(0.01), 0.2)), 1, 0.1) << rulings;
}

TEST(ApexStiffnessTest, RefiningTheWholeMeshChangesTheEnergyByLessThanTenPercent) {
  for (const double edge : {0.02, 0.012, 0.007, 0.004})
    EXPECT_NEAR(gentle(any_mesh(edge)), 1, 0.1) << edge;
}

TEST(ApexStiffnessTest, FactorIsHalfTheMeanLogarithmOverTheAngle) {
  const Paper paper;
  Points2 p(4, 2);
  p << 0, 0, 0.03, 0, -0.01, 0.017, -0.01, -0.025;  // spokes of 30, 20 and 27 mm at obtuse angles
  Triangles t(3, 3);
  t << 0, 1, 2, 0, 2, 3, 0, 3, 1;
  Sheet sheet = test::flat_sheet(p, t);
  sheet.singular.push_back({Vector2d(0, 0), 1, ""});
  const std::vector<double> factors = apex_stiffness_factors(sheet, paper);
  for (int k = 0; k < 3; ++k) {
    const Vector2d a = p.row(t(k, 1)), b = p.row(t(k, 2)), along = b - a;
    double size = 1e9;  // from the apex to the border
    for (int j = 0; j < 3; ++j) {
      const Vector2d c = p.row(t(j, 1)), d = p.row(t(j, 2));
      size = std::min(size, std::abs(cross(c, d)) / (d - c).norm());
    }
    const double from = std::atan2(a.y(), a.x()),
                 turn = std::acos(a.dot(b) / (a.norm() * b.norm()));
    double mean = 0;
    constexpr int n = 2000;
    for (int i = 0; i < n; ++i) {
      const Vector2d u(std::cos(from + (i + 0.5) * turn / n),
                       std::sin(from + (i + 0.5) * turn / n));
      mean += std::log(cross(a, along) / cross(u, along)) / n;
    }
    // the tolerance is the error of Simpson's rule
    EXPECT_NEAR(factors[k], 0.5 * (mean - std::log(core_radius(paper, size))), 0.02) << k;
  }
}

TEST(ApexStiffnessTest, AConeAsSmallAsItsCoreStoresWhatTheCoreDoes) {
  // r_c is 1.8 mm
  const std::vector<double> factors = apex_stiffness_factors(disc(12, {0.001, 0.01, R}), Paper{});
  EXPECT_EQ(*std::min_element(factors.begin(), factors.end()), 0.25);
  EXPECT_EQ(*std::max_element(factors.begin(), factors.end()), 1);
}

TEST(ApexStiffnessTest, TheCoreIsLargerForThickerPaperAndForLargerCones) {
  Paper heavy;
  heavy.thickness *= 8;
  EXPECT_NEAR(core_radius(heavy, R) / core_radius(Paper{}, R), 2, 1e-9);
  EXPECT_NEAR(core_radius(Paper{}, 8 * R) / core_radius(Paper{}, R), 4, 1e-9);
  Sheet sheet = disc(12, rings_from(0.01));
  const double alone = apex_stiffness_factors(sheet, Paper{})[0];
  EXPECT_NEAR(apex_stiffness_factors(sheet, heavy)[0], alone - 0.5 * std::log(2), 1e-9);
  // a second apex where the second ring is: the two cones end at each other
  sheet.singular.push_back({sheet.pattern.row(13), 1, ""});
  int far = 0;  // a triangle that has only the first apex
  while ((sheet.triangles.row(far).array() == 7).count() == 0 ||
         (sheet.triangles.row(far).array() == 0).count() == 0)
    ++far;
  // the border is a polygon
  EXPECT_NEAR(
      apex_stiffness_factors(sheet, Paper{})[far],
      alone + 0.5 * 2.0 / 3 * std::log(R * std::cos(M_PI / 12) / sheet.pattern.row(13).norm()),
      1e-9);
}

TEST(ApexStiffnessTest, OnlyTrianglesAtSingularPointsHaveAFactor) {
  Sheet sheet = disc(12, {0.02, 0.035, R});
  const std::vector<double> factors = apex_stiffness_factors(sheet, Paper{});
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const bool at_apex = (sheet.triangles.row(t).array() == 0).any();
    EXPECT_EQ(factors[t] != 1, at_apex) << t;
  }
  sheet.singular.clear();
  EXPECT_TRUE(apex_stiffness_factors(sheet, Paper{}).empty());
}

TEST(ApexStiffnessTest, ElasticStepsMultiplyTheFactorsByThoseOfTheDiscsOfHandles) {
  Sheet sheet = disc(24, {0.02, 0.035, R});
  test::bend_to_wavy_cone(sheet, eps, saddle);
  const auto bending = [&](const std::vector<double>& stiffening) {
    Elastic elastic(Paper{}, {});
    elastic.set_mesh(sheet, stiffening);
    const ElasticReport stored = elastic.evaluate_energies(sheet);
    return stored.energy - stored.membrane;
  };
  const double with = bending({});
  EXPECT_NEAR(bending(std::vector<double>(sheet.triangles.rows(), 10.0)), 10 * with, 1e-9 * with);
  sheet.singular.clear();
  EXPECT_GT(with, 1.05 * bending({}));
}

}  // namespace
}  // namespace paperbake
