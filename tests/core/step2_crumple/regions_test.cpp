#include "core/step2_crumple/regions.h"

#include "core/geometry/random.h"
#include "tests/core/test_cones.h"
#include "tests/core/test_shots.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace paperbake {
namespace {

constexpr double degree = M_PI / 180;

/// Whether the apex is farther away than ten windows of the fit.
bool is_cylinder(const Cone& cone) {
  return 10 * std::abs(cone.apex.z()) < cone.apex.head<2>().norm();
}

/// [m] on the pattern
Vector2d apex_of(const Cone& cone) {
  return cone.centre + cone.scale * cone.apex.head<2>() / cone.apex.z();
}

std::vector<RulingSample> fan(const Vector2d& apex, double noise) {
  std::vector<RulingSample> samples;
  for (int i = 0; i < 40; ++i) {
    const Vector2d p(0.03 * uniform(7, 2 * i), 0.03 * uniform(7, 2 * i + 1));
    const Vector2d ruling =
        Eigen::Rotation2Dd(noise * gaussian({3, 0, static_cast<std::uint32_t>(i)}, 0).x()) *
        (apex - p).normalized();
    samples.push_back({p, Vector2d(-ruling.y(), ruling.x()), 1.0});
  }
  return samples;
}

TEST(RegionsTest, ConeFitFindsTheApexOfRulingsAndTheAxisOfParallelOnes) {
  const Vector2d apex(-0.05, 0.04);
  EXPECT_LT((apex_of(fit_cone(fan(apex, 0), 0.03, 0)) - apex).norm(), 1e-9);
  const Cone cylinder = fit_cone(fan({3e6, 4e6}, 0), 0.03, 0);
  EXPECT_TRUE(is_cylinder(cylinder));
  EXPECT_LT(std::abs(cylinder.ruling({0.01, 0.02}).dot(Vector2d(-0.8, 0.6))), 1e-6);
  EXPECT_FALSE(is_cylinder(fit_cone(fan(apex, 0), 0.03, 0)));
}

TEST(RegionsTest, NoiseMovesTheFittedApexLittleAndTheRulingsLess) {
  const Vector2d apex(-0.05, 0.04), p(0.01, 0.01);
  const Cone cone = fit_cone(fan(apex, 1.7 * degree), 0.03, 0);
  EXPECT_GT((apex_of(cone) - apex).norm(), 1e-5);   // the noise has an effect
  EXPECT_LT((apex_of(cone) - apex).norm(), 0.004);  // 6 % of the distance
  EXPECT_GT(std::abs(cone.ruling(p).dot((apex - p).normalized())), std::cos(1.0 * degree));
}

TEST(RegionsTest, RegularizationKeepsNoiseOnParallelRulingsFromMakingAnApex) {
  const Cone plain = fit_cone(fan({0, 1e6}, 10 * degree), 0.03, 0),
             pulled = fit_cone(fan({0, 1e6}, 10 * degree), 0.03, 0.5);
  EXPECT_LT(std::abs(pulled.apex.z()), 0.7 * std::abs(plain.apex.z()));
  EXPECT_GT(std::abs(plain.apex.z()), 1e-3);
}

Regions regions_of(const Sheet& sheet, const RulingOptions& options = {}) {
  Regions regions(test::rectangle(0.1, 0.1), options);
  regions.update(BendingField(sheet, vertex_curvature(sheet)));
  return regions;
}

TEST(RegionsTest, ConeIsOneRegionWithItsApex) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  const Vector2d apex(-0.06, 0.05);
  test::bend_to_cone(sheet, apex, 55 * degree);  // 4.4 1/m at its far end
  const Regions regions = regions_of(sheet);
  ASSERT_EQ(regions.all().size(), 1u);
  const CurvedRegion& region = regions.all()[0];
  EXPECT_EQ(region.sign, 1);
  EXPECT_NEAR(region.area, 0.01, 0.002);
  EXPECT_FALSE(is_cylinder(region.cone));
  // the regularization costs a little
  EXPECT_LT((apex_of(region.cone) - apex).norm(), 0.1 * (apex - Vector2d(0.05, 0.05)).norm());
}

TEST(RegionsTest, SBendIsTwoCylindersOfOppositeSigns) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 0.004 * std::sin(2 * M_PI * sheet.pattern(v, 0) / 0.1);
  const Regions regions = regions_of(sheet);
  ASSERT_EQ(regions.all().size(), 2u);
  EXPECT_EQ(regions.all()[0].sign * regions.all()[1].sign, -1);
  for (const CurvedRegion& region : regions.all()) {
    EXPECT_TRUE(is_cylinder(region.cone));
    // twice the slope angle in the middle
    EXPECT_NEAR(region.bend / 0.1, 2 * std::atan(0.004 * 2 * M_PI / 0.1), 0.05);
  }
}

TEST(RegionsTest, ThresholdsHaveHysteresisAndRegionsKeepTheirIds) {
  const RulingOptions options;  // on a sheet of 0.1 m: curved above 3 1/m, flat below 1.8
  Regions regions(test::rectangle(0.1, 0.1), options);
  const auto seen = [&](double k) {
    Sheet sheet = test::hex_sheet(0.1, 0.1, 12);
    test::roll(sheet, 1 / k);
    regions.update(BendingField(sheet, vertex_curvature(sheet)));
    return regions.all().size();
  };
  EXPECT_EQ(seen(2.4), 0u);
  ASSERT_EQ(seen(4.0), 1u);
  const int id = regions.all()[0].id;
  ASSERT_EQ(seen(2.4), 1u);
  EXPECT_EQ(regions.all()[0].id, id);
  EXPECT_EQ(seen(1.2), 0u);
  EXPECT_EQ(seen(2.4), 0u);
  ASSERT_EQ(seen(4.0), 1u);
  EXPECT_NE(regions.all()[0].id, id);  // a region that was flat in between is a new one
}

TEST(RegionsTest, RegionsOfATravellingWaveKeepTheirIds) {
  Regions regions(test::rectangle(0.1, 0.1), {});
  std::vector<int> first;
  for (int frame = 0; frame < 10; ++frame) {
    Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
    for (int v = 0; v < sheet.x.rows(); ++v)
      sheet.x(v, 2) = 0.004 * std::sin(2 * M_PI * (sheet.pattern(v, 0) - 0.002 * frame) / 0.1);
    regions.update(BendingField(sheet, vertex_curvature(sheet)));
    std::vector<int> ids(2, -1);  // by sign; a third region may enter at the border
    for (const CurvedRegion& region : regions.all())
      if (region.area > 0.002) ids[region.sign > 0] = region.id;
    if (frame == 0) first = ids;
    ASSERT_TRUE(std::all_of(ids.begin(), ids.end(), [](int id) { return id >= 0; })) << frame;
    EXPECT_EQ(ids, first) << frame;
  }
}

TEST(RegionsTest, OptionsChangeTheThresholds) {
  Sheet gentle = test::hex_sheet(0.1, 0.1, 12);
  test::roll(gentle, 1 / 2.0);
  RulingOptions low, strict;
  low.curved_above = 0.15;
  EXPECT_EQ(regions_of(gentle).all().size(), 0u);
  EXPECT_EQ(regions_of(gentle, low).all().size(), 1u);
  Sheet dome = test::hex_sheet(0.1, 0.1, 12);
  for (int v = 0; v < dome.x.rows(); ++v)
    // curvatures of 8 and 3.2 1/m
    dome.x(v, 2) =
        -4 * std::pow(dome.pattern(v, 0) - 0.05, 2) - 1.6 * std::pow(dome.pattern(v, 1) - 0.05, 2);
  strict.coherent = 0.2;
  EXPECT_EQ(regions_of(dome).all().size(), 1u);
  EXPECT_EQ(regions_of(dome, strict).all().size(), 0u);
}

}  // namespace
}  // namespace paperbake
