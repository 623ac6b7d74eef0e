#include "core/hands/closing_hands.h"

#include "core/methods/hybrid.h"
#include "tests/core/animation/together_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr int frames = 12;
constexpr double radius = 0.018;  // [m] of the ring of fingertips

/// A sheet of 20 x 15 cm, with five fingertips in a ring round its middle. Until the last frame the
/// ring closes to a share [1] of its radius.
Shot fist(double to) {
  const Vector3d x(1, 0, 0), y(0, 1, 0), corner(0, 0, 0);
  const Vector2d middle(0.1, 0.075);
  Shot shot = test::placed(0.2, 0.15, corner, x, y);
  for (int k = 0; k < 5; ++k) {
    const Vector2d from = radius * Vector2d(std::cos(0.4 * M_PI * k), std::sin(0.4 * M_PI * k));
    test::hold(
        shot, middle + from, frames,
        [=](int f) {
          const Vector2d way = (to - 1) * f / (frames - 1.0) * from;
          return Vector3d(way.x(), way.y(), 0);
        },
        corner, x, y);
  }
  return shot;
}

TEST(ClosingHandsTest, AFistHasPointsBetweenAllItsFingertips) {
  const Shot shot = fist(0.5);
  const std::vector<Vector2d> points = points_in_closing_hands(shot);
  // the five sides of the ring, and within it as many as there is room for
  EXPECT_GE(points.size(), 6u);
  for (const Handle& a : shot.handles)
    for (const Vector2d& p : points) EXPECT_GT((p - a.pattern).norm(), 0.2 * radius);
  for (const Vector2d& p : points) EXPECT_LT((p - Vector2d(0.1, 0.075)).norm(), radius);
}

TEST(ClosingHandsTest, ThereAreNoneWhereThereIsNoPaperBetweenTheFingertips) {
  Shot shot = fist(0.5);
  const double wide = 0.001;  // of a slit through the middle of the fist, from the border
  shot.pattern.outline = {{0, 0},          {0.1 - wide, 0}, {0.1 - wide, 0.1}, {0.1 + wide, 0.1},
                          {0.1 + wide, 0}, {0.2, 0},        {0.2, 0.15},       {0, 0.15}};
  const std::vector<Vector2d> points = points_in_closing_hands(shot);
  EXPECT_LT(points.size(), points_in_closing_hands(fist(0.5)).size());
  for (const Vector2d& p : points) EXPECT_TRUE(contains(shot.pattern, p)) << p.transpose();
}

TEST(ClosingHandsTest, AHandThatKeepsItsShapeHasNone) {
  EXPECT_TRUE(points_in_closing_hands(fist(0.97)).empty());
}

TEST(ClosingHandsTest, TwoRowsThatFoldThePaperBetweenThemHaveNone) {
  // A point beside the line along which it folds would be in its way.
  const Vector3d x(1, 0, 0), y(0, 1, 0), corner(0, 0, 0);
  Shot shot = test::placed(0.2, 0.15, corner, x, y);
  for (const double v : {0.05, 0.06, 0.07})
    for (const double u : {0.09, 0.11})
      test::hold(
          shot, {u, v}, frames,
          [=](int f) { return u > 0.1 ? Vector3d(-0.0015 * f, 0, 0) : Vector3d(0, 0, 0); }, corner,
          x, y);
  EXPECT_TRUE(points_in_closing_hands(shot).empty());
}

TEST(ClosingHandsTest, PaperBendsOutOfTheWayOfAFistThatCloses) {
  // With edges from fingertip to fingertip it is compressed by 4 %.
  const Shot shot = fist(0.85);
  AnimateOptions options;
  options.last_frame = frames;
  double worst = 0;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
          [&](const AnimatedFrame& frame) {
            worst = std::max(worst, length_distortion(*frame.sheet).largest);
            return true;
          });
  EXPECT_LT(worst, 0.02);
}

}  // namespace
}  // namespace paperbake
