#include "core/model/segment2.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

const Vector2d a(1, 1), b(4, 2), c(2, 5);

TEST(Segment2Test, BarycentricCoordinatesGiveThePointBackInsideAndOutside) {
  for (const Vector2d& p : {Vector2d(2, 2), Vector2d(-3, 7), b}) {
    const Vector3d at = barycentric(p, a, b, c);
    EXPECT_NEAR(at.sum(), 1, 1e-15);
    EXPECT_LT((at[0] * a + at[1] * b + at[2] * c - p).norm(), 1e-14);
  }
  EXPECT_LT(barycentric({-3, 7}, a, b, c).minCoeff(), 0) << "it is outside";
  // the part of the area that is opposite to a corner
  const Vector2d inner(2, 2);
  EXPECT_NEAR(barycentric(inner, a, b, c)[2], signed_area(a, b, inner) / signed_area(a, b, c),
              1e-15);
}

TEST(Segment2Test, AnAreaIsNegativeClockwise) {
  EXPECT_DOUBLE_EQ(signed_area({0, 0}, {3, 0}, {0, 2}), 3);
  EXPECT_DOUBLE_EQ(signed_area({0, 0}, {0, 2}, {3, 0}), -3);
}

TEST(Segment2Test, TheNearestPointIsWithinTheEndsAlsoOfASinglePoint) {
  EXPECT_DOUBLE_EQ(nearest_share({1, 5}, {0, 0}, {4, 0}), 0.25);
  EXPECT_DOUBLE_EQ(distance_to_segment({1, 5}, {0, 0}, {4, 0}), 5);
  EXPECT_EQ(nearest_on_segment({-3, 4}, {0, 0}, {4, 0}), Vector2d(0, 0));
  EXPECT_EQ(nearest_on_segment({9, 1}, {0, 0}, {4, 0}), Vector2d(4, 0));
  EXPECT_DOUBLE_EQ(distance_to_segment({3, 4}, {0, 0}, {0, 0}), 5);
}

TEST(Segment2Test, LinesMeetInOnePointUnlessTheyAreParallel) {
  const Line2 one{{0, 1}, {2, 0}}, two{{3, -1}, {0, 4}};
  const auto meet = where_lines_meet(one, two, 1e-9);
  ASSERT_TRUE(meet);
  EXPECT_DOUBLE_EQ(meet->on_first, 1.5);
  EXPECT_DOUBLE_EQ(meet->on_second, 0.5);
  EXPECT_FALSE(where_lines_meet(one, {{0, 2}, {-1, 0}}, 1e-9));
  // the bound is a sine, whatever the lengths
  const Line2 slightly_turned{{0, 0}, {100, 1}};
  EXPECT_FALSE(where_lines_meet(one, slightly_turned, 0.011));
  EXPECT_TRUE(where_lines_meet(one, slightly_turned, 0.009));
}

TEST(Segment2Test, AWayMeetsASegmentOnlyBetweenItsEnds) {
  const Segment2 way{{0, 0}, {1, 0}};
  EXPECT_DOUBLE_EQ(meeting(way, {{5, -1}, {5, 1}}).value(), 5) << "the way goes on";
  EXPECT_FALSE(meeting(way, {{5, 1}, {5, 3}}));
  EXPECT_FALSE(meeting(way, {{0, 1}, {4, 1.01}})) << "nearly parallel";
}

}  // namespace
}  // namespace paperbake
