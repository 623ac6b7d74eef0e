#include "core/step2_crumple/rulings.h"
#include "core/model/segment2.h"

#include "tests/core/test_cones.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

constexpr double degree = M_PI / 180;
constexpr double h = 0.015;

bool cross_each_other(const Ruling& r, const Ruling& s) {
  return cross(r.b - r.a, s.a - r.a) * cross(r.b - r.a, s.b - r.a) < 0 &&
         cross(s.b - s.a, r.a - s.a) * cross(s.b - s.a, r.b - s.a) < 0;
}

std::vector<Ruling> rulings_of(const Sheet& sheet, const RulingOptions& options = {},
                               const std::vector<Disc>& keep_out_discs = {},
                               const std::vector<Vector2d>& loaded_corners = {}) {
  const Pattern pattern = test::rectangle(0.1, 0.1);
  const BendingField field(sheet, vertex_curvature(sheet));
  Regions regions(pattern, options);
  regions.update(field);
  return place_rulings(pattern, field, regions, {keep_out_discs, loaded_corners}, h, options);
}

void expect_no_crossings(const std::vector<Ruling>& rulings) {
  for (std::size_t i = 0; i < rulings.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_FALSE(cross_each_other(rulings[i], rulings[j])) << i << " " << j;
}

/// Expects equal turning angles between neighbouring rulings, except at the corners of the sheet,
/// where a last ruling is fitted in.
void expect_equal_turns(std::vector<double> sample_points, double turn_per_place,
                        double turn_per_ruling) {
  std::sort(sample_points.begin(), sample_points.end());
  std::vector<double> turns;
  for (std::size_t i = 0; i + 1 < sample_points.size(); ++i)
    turns.push_back((sample_points[i + 1] - sample_points[i]) * turn_per_place / turn_per_ruling);
  std::sort(turns.begin(), turns.end());
  EXPECT_GT(turns.front(), 0.5);
  EXPECT_LT(turns.back(), 1.4);
  EXPECT_NEAR(turns[turns.size() / 4], 1, 0.15);
  EXPECT_NEAR(turns[turns.size() / 2], 1, 0.1);
  EXPECT_NEAR(turns[turns.size() * 3 / 4], 1, 0.15);
}

TEST(RulingsTest, CylinderHasParallelRulingsWithEqualTurns) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  const double R = 0.06, c = std::cos(0.5), s = std::sin(0.5);  // rulings at 0.5 rad from y
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const double u = c * sheet.pattern(v, 0) + s * sheet.pattern(v, 1),
                 w = -s * sheet.pattern(v, 0) + c * sheet.pattern(v, 1);
    sheet.x.row(v) << R * std::sin(u / R), w, R * (std::cos(u / R) - 1);
  }
  RulingOptions options;
  options.across_least = 0.3;  // 4.5 mm; the turning angle alone asks for 4.8
  const std::vector<Ruling> rulings = rulings_of(sheet, options);
  ASSERT_GE(rulings.size(), 12u);
  expect_no_crossings(rulings);
  std::vector<double> offsets;
  for (const Ruling& r : rulings) {
    // less exact at the corners, where the border cuts the one-rings
    EXPECT_LT(std::abs((r.b - r.a).normalized().dot(Vector2d(c, s))), std::sin(4 * degree));
    EXPECT_NEAR(r.k * R, 1, 0.1);
    offsets.push_back(0.5 * (r.a + r.b).dot(Vector2d(c, s)));
  }
  expect_equal_turns(offsets, 1 / R, options.turn_per_ruling);
}

TEST(RulingsTest, ConeHasAFanOfRulingsWithEqualTurns) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  const Vector2d apex(-0.06, 0.05);
  const double slope = 50 * degree;
  test::bend_to_cone(sheet, apex, slope);
  RulingOptions options;
  options.across_most = 2;  // the turning angle alone sets the distance
  const std::vector<Ruling> rulings = rulings_of(sheet, options);
  ASSERT_GE(rulings.size(), 5u);
  expect_no_crossings(rulings);
  std::vector<double> angles;
  for (const Ruling& r : rulings) {
    const Vector2d middle = 0.5 * (r.a + r.b), towards = (apex - middle).normalized();
    EXPECT_GT(std::abs((r.b - r.a).normalized().dot(towards)), std::cos(4 * degree));
    angles.push_back(std::atan2(-towards.y(), -towards.x()));
  }
  std::sort(angles.begin(), angles.end());
  // a fan: seen from 60 mm away, the sheet spans at most 1.3 rad
  EXPECT_GT(angles.back() - angles.front(), 0.5);
  // the fold between facets dphi apart is dphi / tan(slope)
  expect_equal_turns(angles, 1 / std::tan(slope), options.turn_per_ruling);
}

TEST(RulingsTest, OptionsSetTheDistanceBetweenRulings) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  test::roll(sheet, 0.06);
  const auto count = [&](const RulingOptions& options) {
    return rulings_of(sheet, options).size();
  };
  RulingOptions usual;
  usual.turn_per_ruling = 0.08;
  usual.across_least = 0.2;  // 3 mm; the turning angle alone asks for 4.8
  RulingOptions coarse = usual, near = usual, far = usual;
  coarse.turn_per_ruling = 2 * usual.turn_per_ruling;
  near.across_most = 0.25;  // 3.8 mm
  far.across_least = 0.75;
  far.across_most = 1;
  far.turn_per_ruling = 0.01;
  EXPECT_NEAR(double(count(usual)) / count(coarse), 2, 0.3);
  EXPECT_GT(count(near), 1.15 * count(usual));
  EXPECT_LT(count(far), 0.1 / (0.7 * 0.75 * h));
}

TEST(RulingsTest, ShortRulingsAtALoadedCornerAreCloserToEachOther) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 40);
  const double R = 0.01;  // the turning angle alone asks for 1 mm
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double across = (sheet.pattern(v, 0) + sheet.pattern(v, 1)) / std::sqrt(2),
                 along = (sheet.pattern(v, 0) - sheet.pattern(v, 1)) / std::sqrt(2);
    sheet.x.row(v) << R * std::sin(across / R), along, R * std::cos(across / R);
  }
  const Vector2d tip(0.1, 0.1), other(0, 0);
  const auto beside = [&](const std::vector<Ruling>& rulings, const Vector2d& corner) {
    std::vector<double> depths;
    for (const Ruling& r : rulings)
      if (const double depth = (0.5 * (r.a + r.b) - corner).norm(); depth < 1.6 * h)
        depths.push_back(depth);
    std::sort(depths.begin(), depths.end());
    return depths;
  };
  const std::vector<double> usual = beside(rulings_of(sheet), tip),
                            pulled = beside(rulings_of(sheet, {}, {}, {tip}), tip);
  const std::vector<double> opposite = beside(rulings_of(sheet, {}, {}, {tip}), other);
  for (const auto* depths : {&usual, &opposite}) {
    ASSERT_GE(depths->size(), 2u);
    EXPECT_GE(depths->front(), 0.4 * h);  // they are twice as long as they are deep
    for (std::size_t k = 0; k + 1 < depths->size(); ++k)
      EXPECT_GE((*depths)[k + 1] - (*depths)[k], 0.49 * h);
  }
  EXPECT_LT(pulled.front(), 0.3 * h);
  EXPECT_GE(pulled.size(), 2 * usual.size());
}

TEST(RulingsTest, RulingsStayOutOfKeepOutDiscsAndAFlatSheetHasNone) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  EXPECT_TRUE(rulings_of(sheet).empty());
  test::roll(sheet, 0.06);
  const Disc guard{{0.05, 0.0}, 0.03};
  const std::vector<Ruling> rulings = rulings_of(sheet, {}, {guard});
  ASSERT_GE(rulings.size(), 10u);
  for (const Ruling& r : rulings)
    for (double t = 0; t <= 1; t += 0.05)
      EXPECT_GT((r.a + t * (r.b - r.a) - guard.centre).norm(), 0.999 * guard.radius);
}

}  // namespace
}  // namespace paperbake
