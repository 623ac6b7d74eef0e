#include "core/step1_elastic/contact/separation_bound.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <random>

namespace paperbake {
namespace {

/// Least distance in space over distance on the pattern, of any two vertices.
double min_share(const Points2& pattern, const Points3& x) {
  double least = 1e300;
  for (int a = 0; a < x.rows(); ++a)
    for (int b = 0; b < a; ++b)
      least =
          std::min(least, (x.row(a) - x.row(b)).norm() / (pattern.row(a) - pattern.row(b)).norm());
  return least;
}

TEST(SeparationBoundTest, HoldsWhereItSaysSoAllAlongTheWay) {
  const Sheet flat = test::hex_sheet(0.2, 0.15, 12, 0.2);
  const SeparationBound spread(flat.pattern, flat.triangles);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  int held = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto crumpled = [&](double by) {  // waves and a turn, not isometric
      Points3 x = flat.x;
      const double k = 40 * number(random), l = 40 * number(random), turn = 0.8 * number(random);
      const Vector3d along(number(random), number(random), number(random));
      for (int v = 0; v < x.rows(); ++v)
        x.row(v) +=
            by * std::sin(k * flat.pattern(v, 0) + l * flat.pattern(v, 1)) * along.transpose();
      return Points3(
          x * Eigen::AngleAxisd(turn, Vector3d(number(random), number(random), 1).normalized())
                  .toRotationMatrix());
    };
    const double by = 0.06 * std::abs(number(random));
    const Points3 from = crumpled(by), to = crumpled(by);
    if (!spread.holds_along_step(from, to, 0.3)) continue;
    ++held;
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0})
      EXPECT_GE(min_share(flat.pattern, (1 - t) * from + t * to), 0.3);
  }
  EXPECT_GT(held, 60);
  EXPECT_LT(held, 270);
}

TEST(SeparationBoundTest, SeesARollUntilItBendsBack) {
  Sheet sheet = test::hex_sheet(0.2, 0.2, 10, 0.2);
  const Points3 flat = sheet.x;
  const SeparationBound spread(sheet.pattern, sheet.triangles);
  EXPECT_TRUE(spread.holds_along_step(flat, flat, 0.3));
  // turned by pi in its plane: a straight way goes through a point
  EXPECT_TRUE(spread.holds_along_step(flat, -flat, 0.3) == false);
  test::roll(sheet, 0.1);
  EXPECT_TRUE(spread.holds_along_step(sheet.x, sheet.x, 0.3));  // 2 rad
  test::roll(sheet, 0.05);
  EXPECT_FALSE(spread.holds_along_step(sheet.x, sheet.x, 0.3));  // 4 rad: the ends face each other
}

TEST(SeparationBoundTest, KnowsNothingOfPatternsThatAreNotConvex) {
  const Sheet whole = test::hex_sheet(0.2, 0.2, 10, 0.2);
  const auto without = [&](auto left_out) {
    std::vector<Eigen::RowVector3i> kept;
    for (int t = 0; t < whole.triangles.rows(); ++t) {
      const Eigen::RowVector2d centre =
          (whole.pattern.row(whole.triangles(t, 0)) + whole.pattern.row(whole.triangles(t, 1)) +
           whole.pattern.row(whole.triangles(t, 2))) /
          3;
      if (!left_out(centre)) kept.push_back(whole.triangles.row(t));
    }
    Triangles triangles(kept.size(), 3);
    for (std::size_t t = 0; t < kept.size(); ++t) triangles.row(t) = kept[t];
    return SeparationBound(whole.pattern, triangles).holds_along_step(whole.x, whole.x, 0.3);
  };
  EXPECT_TRUE(without([](const auto&) { return false; }));
  // an L
  EXPECT_FALSE(without([](const auto& p) { return p.x() > 0.1 && p.y() > 0.1; }));
  // a hole
  EXPECT_FALSE(
      without([](const auto& p) { return (p - Eigen::RowVector2d(0.1, 0.1)).norm() < 0.05; }));
}

}  // namespace
}  // namespace paperbake
