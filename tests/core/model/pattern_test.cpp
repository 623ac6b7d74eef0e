#include "core/model/pattern.h"

#include "tests/core/test_shots.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

using test::ell;

Pattern square(double side) { return {{{0, 0}, {side, 0}, {side, side}, {0, side}}, {}}; }

// A 0.3 m square with a 0.1 m square hole in its middle.
Pattern frame() {
  return {{{0, 0}, {0.3, 0}, {0.3, 0.3}, {0, 0.3}},
          {{{0.1, 0.1}, {0.1, 0.2}, {0.2, 0.2}, {0.2, 0.1}}}};
}

// A comb with `teeth` slots, each 0.9 deep: the path from end to end goes up and down.
Pattern comb(int teeth) {
  Pattern pattern;
  for (int i = 0; i < teeth; ++i) {
    const double x = i;
    pattern.outline.insert(pattern.outline.end(),
                           {{x, 0}, {x + 0.5, 0}, {x + 0.5, 0.9}, {x + 1, 0.9}});
  }
  pattern.outline.insert(pattern.outline.end(),
                         {{double(teeth), 0}, {teeth + 0.5, 0}, {teeth + 0.5, 1}, {0, 1}});
  return pattern;
}

constexpr double exact = 1e-12;  // sums of a few square roots in double precision

TEST(PatternTest, MeasuresOfAnLShape) {
  EXPECT_NEAR(area(ell()), 0.03, exact);
  EXPECT_NEAR(longer_side(ell()), 0.2, exact);
  const Pattern strip{{{0, 0}, {0.3, 0}, {0.3, 0.03}, {0, 0.03}}, {}};
  EXPECT_NEAR(shorter_side(strip), 0.03, exact);
  EXPECT_NEAR((extent(strip) - Vector2d(0.3, 0.03)).norm(), 0, exact);
}

TEST(PatternTest, AreaExcludesHoles) { EXPECT_NEAR(area(frame()), 0.08, exact); }

TEST(PatternTest, TheBorderBelongsToThePattern) {
  for (double t : {0.0, 0.1, 1.0 / 3, 0.7, 1.0}) {
    const double s = 0.21 * t;
    for (const Vector2d& p : {Vector2d(s, 0), Vector2d(0.21, s), Vector2d(s, 0.21), Vector2d(0, s)})
      EXPECT_TRUE(contains(square(0.21), p)) << p.transpose();
  }
  EXPECT_TRUE(contains(frame(), {0.15, 0.1}));  // the border of the hole
}

TEST(PatternTest, ToleranceWidensTheBorderByThatMuch) {
  EXPECT_FALSE(contains(square(0.1), {-1e-6, 0.05}));
  EXPECT_TRUE(contains(square(0.1), {-1e-6, 0.05}, 1.1e-6));
  EXPECT_FALSE(contains(square(0.1), {-1e-6, 0.05}, 0.9e-6));
  EXPECT_FALSE(contains(frame(), {0.15, 0.15}, 0.049));  // 0.05 from the border
  EXPECT_TRUE(contains(frame(), {0.15, 0.15}, 0.051));
}

TEST(PatternTest, ARayThroughCornersCountsThemOnce) {
  EXPECT_FALSE(contains(ell(), {-0.1, 0.1}));
  EXPECT_FALSE(contains(ell(), {0.15, 0.15}));
  EXPECT_TRUE(contains(ell(), {0.05, 0.1}));
  EXPECT_FALSE(contains(frame(), {0.15, 0.15}));
  EXPECT_TRUE(contains(frame(), {0.05, 0.2}));
}

TEST(PatternTest, NearestBorderPointMayLieOnAHole) {
  EXPECT_NEAR((nearest_border_point(frame(), {0.15, 0.08}) - Vector2d(0.15, 0.1)).norm(), 0, exact);
  EXPECT_NEAR((nearest_border_point(frame(), {0.02, 0.15}) - Vector2d(0, 0.15)).norm(), 0, exact);
  EXPECT_NEAR((nearest_border_point(square(0.1), {-1, -1}) - Vector2d(0, 0)).norm(), 0, exact);
}

TEST(PatternTest, PaperDistanceIsStraightInAConvexSheet) {
  EXPECT_NEAR(paper_distance(square(0.1), {0, 0}, {0.1, 0.1}), 0.1 * std::sqrt(2.0), exact);
  EXPECT_NEAR(paper_distance(square(0.1), {0, 0.03}, {0, 0.07}), 0.04, exact);  // along the border
  EXPECT_NEAR(paper_distance(square(0.1), {0.02, 0.02}, {0.02, 0.02}), 0, exact);
}

TEST(PatternTest, PaperDistanceGoesAroundTheReentrantCorner) {
  const Vector2d a(0.2, 0.05), b(0.05, 0.2), corner(0.1, 0.1);
  EXPECT_NEAR(paper_distance(ell(), a, b), (a - corner).norm() + (corner - b).norm(), exact);
  // both segments run along the border
  EXPECT_NEAR(paper_distance(ell(), {0.2, 0.1}, {0.1, 0.2}), 0.2, exact);
}

TEST(PatternTest, APathThroughTheReentrantCornerMayBeStraight) {
  EXPECT_NEAR(paper_distance(ell(), {0.2, 0}, {0, 0.2}), 0.2 * std::sqrt(2.0), exact);
}

TEST(PatternTest, PaperDistanceGoesAroundAHoleOnTheShorterSide) {
  const Vector2d a(0.05, 0.12), b(0.25, 0.12);  // closer to the lower border of the hole
  const double below = (a - Vector2d(0.1, 0.1)).norm() + 0.1 + (Vector2d(0.2, 0.1) - b).norm();
  EXPECT_NEAR(paper_distance(frame(), a, b), below, exact);
  // from corner to corner of the hole
  EXPECT_NEAR(paper_distance(frame(), {0.1, 0.1}, {0.2, 0.2}), 0.2, exact);
}

TEST(PatternTest, PaperDistanceWindsThroughManyCorners) {
  // up to the corner of the first slot, past the inner teeth along y = 0.9, and down at the other
  // end
  const double way = std::hypot(0.5, 0.9) + 3.5 + std::hypot(0.5, 0.9);
  EXPECT_NEAR(paper_distance(comb(4), {0, 0}, {4.5, 0}), way, exact);
}

TEST(PatternTest, PaperDistanceIsSymmetricAndNeverShorterThanStraight) {
  const std::vector<Vector2d> points = {{0, 0},      {0.3, 0.3},   {0.1, 0.15},
                                        {0.2, 0.17}, {0.29, 0.01}, {0.15, 0.25}};
  for (const auto& a : points)
    for (const auto& b : points) {
      EXPECT_NEAR(paper_distance(frame(), a, b), paper_distance(frame(), b, a), exact);
      EXPECT_GE(paper_distance(frame(), a, b), (a - b).norm() - exact);
    }
}

TEST(PatternTest, PointsSlightlyOutsideAreMovedToTheBorder) {
  const double rounding = 1e-8;  // of a 32-bit file
  EXPECT_NEAR(paper_distance(square(0.1), {-rounding, 0.03}, {-rounding, 0.07}), 0.04, exact);
  EXPECT_NEAR(paper_distance(ell(), {0.2, 0.1 + rounding}, {0.1 + rounding, 0.2}), 0.2, 1e-7);
}

TEST(PatternTest, TheMeanWidthOfAStripIsItsWidthWhereverItPointsTo) {
  EXPECT_NEAR(mean_width(test::rectangle(1, 0.03)), 0.03, 1e-4);
  Pattern slanted;
  for (const Vector2d& p : test::rectangle(1, 0.03).outline)
    slanted.outline.push_back(Eigen::Rotation2Dd(0.7) * p);
  EXPECT_NEAR(mean_width(slanted), mean_width(test::rectangle(1, 0.03)), 1e-12);
}

}  // namespace
}  // namespace paperbake
