#include "core/model/handles.h"

#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <random>

namespace paperbake {
namespace {

using test::rectangle;

Handle finger(const Vector2d& pattern) {
  Handle handle;
  handle.pattern = pattern;
  return handle;
}

int on_border(const Pattern& pattern, const std::vector<Vector2d>& rim) {
  return static_cast<int>(std::count_if(rim.begin(), rim.end(), [&](const Vector2d& p) {
    // placed on the border, not just near it
    return (nearest_border_point(pattern, p) - p).norm() < 1e-12;
  }));
}

/// Expects every rim point to lie in the sheet and at the radius, and no two to be close to each
/// other.
void expect_rim(const Pattern& pattern, const Vector2d& centre, double radius,
                const std::vector<Vector2d>& rim) {
  for (std::size_t i = 0; i < rim.size(); ++i) {
    EXPECT_TRUE(contains(pattern, rim[i])) << rim[i].transpose();
    // the border is met to a millionth of the radius
    EXPECT_NEAR((rim[i] - centre).norm() / radius, 1, 1e-5);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((rim[i] - rim[j]).norm(), 1e-3 * radius);
  }
}

TEST(HandlesTest, AHandleRestsBeforeItsFirstAndAfterItsLastKey) {
  Handle handle;
  handle.keyed.resize(3, 3);
  handle.keyed << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  EXPECT_EQ(keyed_position(handle, -5), Vector3d(1, 2, 3));
  EXPECT_EQ(keyed_position(handle, 0), Vector3d(1, 2, 3));
  EXPECT_EQ(keyed_position(handle, 1), Vector3d(4, 5, 6));
  EXPECT_EQ(keyed_position(handle, 2), Vector3d(7, 8, 9));
  EXPECT_EQ(keyed_position(handle, 100), Vector3d(7, 8, 9));
}

TEST(HandlesTest, AHandleIsHeldFromItsGrabFrameUpToItsReleaseFrame) {
  Handle handle;
  EXPECT_TRUE(handle.held(-1000) && handle.held(1000));
  handle.grab_frame = 5;
  handle.release_frame = 8;
  EXPECT_FALSE(handle.held(4));
  EXPECT_TRUE(handle.held(5) && handle.held(7));
  EXPECT_FALSE(handle.held(8));
}

TEST(HandlesTest, TheDiscOfALoneHandleIsAsLargeAsAFinger) {
  EXPECT_EQ(disc_radius({finger({0.1, 0.1})}, 0, rectangle(0.3, 0.3)), 0.010);
}

TEST(HandlesTest, OnASmallSheetTheDiscOfALoneHandleIsATwentiethOfTheShorterSide) {
  EXPECT_NEAR(disc_radius({finger({0.1, 0.02})}, 0, rectangle(0.3, 0.04)), 0.002, 1e-15);
}

TEST(HandlesTest, HandlesInARowHaveNoDiscs) {
  const Pattern sheet = rectangle(0.3, 0.3);
  std::vector<Handle> row;
  for (int i = 0; i <= 10; ++i) row.push_back(finger({0, 0.03 * i * 0.99}));
  for (std::size_t h = 0; h < row.size(); ++h) EXPECT_EQ(disc_radius(row, h, sheet), 0);
}

TEST(HandlesTest, AnotherHandleWithin30MillimetresMakesARow) {
  const Pattern sheet = rectangle(0.3, 0.3);
  EXPECT_EQ(disc_radius({finger({0.1, 0.1}), finger({0.129, 0.1})}, 0, sheet), 0);
  EXPECT_EQ(disc_radius({finger({0.1, 0.1}), finger({0.131, 0.1})}, 0, sheet), 0.010);
}

TEST(HandlesTest, OnASmallSheetAnotherHandleWithin15PercentOfTheShorterSideMakesARow) {
  const Pattern sheet = rectangle(0.2, 0.1);
  EXPECT_EQ(disc_radius({finger({0.1, 0.05}), finger({0.114, 0.05})}, 1, sheet), 0);
  EXPECT_NEAR(disc_radius({finger({0.1, 0.05}), finger({0.116, 0.05})}, 1, sheet), 0.005, 1e-15);
}

TEST(HandlesTest, AnExplicitDiscRadiusIsKeptWhateverIsNear) {
  std::vector<Handle> handles = {finger({0.1, 0.1}), finger({0.105, 0.1})};
  handles[0].radius = 0.02;
  EXPECT_EQ(disc_radius(handles, 0, rectangle(0.3, 0.3)), 0.02);
  handles[0].radius = 0;
  EXPECT_EQ(disc_radius(handles, 0, rectangle(0.3, 0.3)), 0);
  EXPECT_EQ(disc_radius({handles[0]}, 0, rectangle(0.3, 0.3)), 0);
}

TEST(HandlesTest, TheRimOfABarePointIsEmpty) {
  EXPECT_TRUE(disc_rim(rectangle(0.1, 0.1), {0.05, 0.05}, 0).empty());
}

TEST(HandlesTest, TheRimInsideTheSheetIsARegularHexagon) {
  const Pattern sheet = rectangle(0.1, 0.1);
  const Vector2d centre(0.04, 0.06);
  const std::vector<Vector2d> rim = disc_rim(sheet, centre, 0.01);
  ASSERT_EQ(rim.size(), 6u);
  expect_rim(sheet, centre, 0.01, rim);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((rim[i] - rim[(i + 1) % 6]).norm(), 0.01, 1e-12);
}

TEST(HandlesTest, TheRimAtAStraightBorderHasFourPointsTwoOfThemOnTheBorder) {
  const Pattern sheet = rectangle(0.1, 0.07);
  for (const Vector2d& centre :
       {Vector2d(0.03, 0), Vector2d(0.1, 0.03), Vector2d(0.03, 0.07), Vector2d(0, 0.03)}) {
    const std::vector<Vector2d> rim = disc_rim(sheet, centre, 0.01);
    ASSERT_EQ(rim.size(), 4u) << centre.transpose();
    expect_rim(sheet, centre, 0.01, rim);
    EXPECT_EQ(on_border(sheet, rim), 2);
    // 60 degrees from one to the next
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((rim[i] - rim[i + 1]).norm(), 0.01, 1e-7);
  }
}

TEST(HandlesTest, TheRimAtACornerHasThreePointsTwoOfThemOnTheBorder) {
  const Pattern sheet = rectangle(0.1, 0.07);
  for (const Vector2d& corner : sheet.outline) {
    const std::vector<Vector2d> rim = disc_rim(sheet, corner, 0.01);
    ASSERT_EQ(rim.size(), 3u) << corner.transpose();
    expect_rim(sheet, corner, 0.01, rim);
    EXPECT_EQ(on_border(sheet, rim), 2);
  }
}

TEST(HandlesTest, ARimCutByTheBorderEndsOnTheBorderAtItsRadius) {
  const Pattern sheet = rectangle(0.1, 0.07);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.001, 0.009), along(0.02, 0.05);
  for (int k = 0; k < 200; ++k) {
    const Vector2d centre(along(random), uniform(random));
    const std::vector<Vector2d> rim = disc_rim(sheet, centre, 0.01);
    EXPECT_GE(rim.size(), 4u);  // half a circle or more
    expect_rim(sheet, centre, 0.01, rim);
    EXPECT_EQ(on_border(sheet, rim), 2) << centre.transpose();
  }
}

TEST(HandlesTest, ARimThatHardlyPassesTheBorderTouchesItInOnePoint) {
  const Pattern sheet = rectangle(0.1, 0.07);
  for (const double beyond : {-1e-9, 1e-9, 1e-6, 1e-5}) {
    const std::vector<Vector2d> rim = disc_rim(sheet, {0.03, 0.01 - beyond}, 0.01);
    for (std::size_t i = 0; i < rim.size(); ++i)
      EXPECT_GT((rim[i] - rim[(i + 1) % rim.size()]).norm(), 1e-3) << beyond;
    EXPECT_LE(on_border(sheet, rim), 1) << beyond;
    EXPECT_GE(rim.size(), 5u) << beyond;
  }
}

TEST(HandlesTest, TheRimBetweenTwoBordersHasTwoArcs) {
  const Pattern strip = rectangle(0.1, 0.01);
  const std::vector<Vector2d> rim = disc_rim(strip, {0.05, 0.004}, 0.015);
  ASSERT_EQ(rim.size(), 4u);
  expect_rim(strip, {0.05, 0.004}, 0.015, rim);
  EXPECT_EQ(on_border(strip, rim), 4);
}

TEST(HandlesTest, ARimPointThatNearlyTouchesTheBorderIsPutOnIt) {
  const Pattern sheet = rectangle(0.1, 0.1);
  // a hundredth of the radius away
  const std::vector<Vector2d> rim = disc_rim(sheet, {0.0101, 0.05}, 0.01);
  ASSERT_EQ(rim.size(), 6u);
  EXPECT_EQ(on_border(sheet, rim), 1);
  EXPECT_EQ(on_border(sheet, disc_rim(sheet, {0.0103, 0.05}, 0.01)), 0);
}

TEST(HandlesTest, TheRimGoesAroundAHole) {
  Pattern sheet = rectangle(0.1, 0.1);
  sheet.holes = {{{0.05, 0.04}, {0.05, 0.06}, {0.07, 0.06}, {0.07, 0.04}}};
  const std::vector<Vector2d> rim = disc_rim(sheet, {0.04, 0.05}, 0.012);
  ASSERT_GE(rim.size(), 6u);
  expect_rim(sheet, {0.04, 0.05}, 0.012, rim);
  EXPECT_EQ(on_border(sheet, rim), 2);
}

TEST(HandlesTest, TheRimOfADiscLargerThanTheSheetIsEmpty) {
  EXPECT_TRUE(disc_rim(rectangle(0.1, 0.1), {0.05, 0.05}, 0.2).empty());
}

}  // namespace
}  // namespace paperbake
