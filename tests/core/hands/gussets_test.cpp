#include "core/hands/gussets.h"

#include "core/geometry/hinges.h"
#include "core/hands/folding_hands.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace paperbake {
namespace {

constexpr double degrees = M_PI / 180;
constexpr int frames = 19;

/// [rad] Dihedral angle at the edge from the crossing to `axis`, with the paper beside it.
double angle_at(const Vector3d& axis, const Vector3d& left, const Vector3d& right) {
  Points3 x(4, 3);
  x << 0, 0, 0, axis.transpose(), left.transpose(), right.transpose();
  return dihedral_angle(x, {{0, 1, 2, 3}, {0, 1}});
}

TEST(GussetShapeTest, ItsSectorsStayFlatAndItsTurnsAreThoseOfTheirEdges) {
  for (const double angle : {60.0, 90.0, 115.0})
    for (const double a : {20.0, 75.0, -50.0})
      for (const double b : {8.0, 45.0, 90.0})
        for (const bool outwards : {true, false}) {
          const double g = angle * degrees, sign = a > 0 ? 1 : -1;
          const auto shape = gusset_shape(g, a * degrees, sign * b * degrees, outwards);
          ASSERT_TRUE(shape) << angle << " " << a << " " << b;
          const Vector3d one = Vector3d::UnitX(), two(std::cos(g), std::sin(g), 0),
                         right = shape->borders[0], left = shape->borders[1],
                         middle = shape->bisector;
          EXPECT_NEAR(middle.norm(), 1, 1e-12);
          EXPECT_NEAR(right.dot(-two), -std::cos(g), 1e-12) << "the third sector";
          EXPECT_NEAR(left.dot(-one), -std::cos(g), 1e-12) << "the second sector";
          EXPECT_NEAR(right.dot(middle), std::cos(g / 2), 1e-12) << "a half of the fourth";
          EXPECT_NEAR(left.dot(middle), std::cos(g / 2), 1e-12) << "the other half";
          // the lines before the crossing: the first and the second sector, the first and the third
          EXPECT_NEAR(angle_at(-one, -two, left), a * degrees, 1e-12);
          EXPECT_NEAR(angle_at(-two, right, -one), sign * b * degrees, 1e-12);
          EXPECT_NEAR(angle_at(middle, left, right), shape->turn, 1e-12);
          EXPECT_NEAR(angle_at(right, middle, -two), shape->beyond[0], 1e-12);
          EXPECT_NEAR(angle_at(left, -one, middle), shape->beyond[1], 1e-12);
          EXPECT_EQ(shape->turn > 0, (a > 0) == outwards);
        }
}

TEST(GussetShapeTest, TheCornerOfABoxIsShutWithTwoSidesThatStandOffByHalfARightAngle) {
  const double nearly = 90 * degrees - 1e-6;
  const auto shape = gusset_shape(90 * degrees, nearly, nearly, true);
  ASSERT_TRUE(shape);
  EXPECT_NEAR(shape->turn, 180 * degrees, 1e-5);
  for (const double beyond : shape->beyond) EXPECT_NEAR(beyond, -45 * degrees, 1e-5);
}

TEST(GussetShapeTest, AFourthSectorThatWouldHaveToStretchDoesNotFollow) {
  EXPECT_FALSE(gusset_shape(90 * degrees, 40 * degrees, -40 * degrees, true))
      << "the two lines bulge to different sides";
  // cos g tan(a/2) tan(b/2) > 1
  EXPECT_FALSE(gusset_shape(60 * degrees, 120 * degrees, 120 * degrees, true));
  EXPECT_TRUE(gusset_shape(60 * degrees, 100 * degrees, 100 * degrees, true));
}

// A sheet that is wrapped round a box

constexpr double side = 0.3, low = 0.088, high = 0.212;  // [m] the sheet, and where it is folded
const Vector2d corners[] = {{0, 0}, {side, 0}, {side, side}, {0, side}};
const Vector2d crossings[] = {{low, low}, {high, low}, {high, high}, {low, high}};

using Turn = std::function<double(double share)>;  // [rad] of the time, from 0 to 1
Turn evenly(double angle) {
  return [=](double share) { return share * angle; };
}

/// The turn about a line of the flat sheet, right-handed about its direction.
Eigen::Isometry3d turned(double angle, const Vector2d& on, const Vector2d& axis) {
  const Vector3d origin(on.x(), on.y(), 0);
  return Eigen::Translation3d(origin) * Eigen::AngleAxisd(angle, Vector3d(axis.x(), axis.y(), 0)) *
         Eigen::Translation3d(-origin);
}

using Pose = std::function<Eigen::Isometry3d(double share)>;  // of the time, from 0 to 1

void hold(Shot& shot, const std::vector<Vector2d>& points, const Pose& pose) {
  for (const Vector2d& p : points) {
    Handle handle = test::bare_handle("handle." + std::to_string(shot.handles.size()), p, frames);
    for (int f = 0; f < frames; ++f)
      handle.keyed.row(f) = pose(f / (frames - 1.0)) * Vector3d(p.x(), p.y(), 0);
    shot.handles.push_back(handle);
  }
}

void hold(Shot& shot, const std::vector<Vector2d>& points, const Vector2d& on, const Vector2d& axis,
          const Turn& turn) {
  hold(shot, points, [&](double share) { return turned(turn(share), on, axis); });
}

/// The middle is held, and four rows on the border turn down, two by `first` and two by `second`.
Shot wrapped(const Turn& first, const Turn& second) {
  Shot shot = test::blank_shot(test::rectangle(side, side));
  hold(shot, {{0.15, 0.15}, {0.11, 0.15}, {0.19, 0.15}, {0.15, 0.11}, {0.15, 0.19}}, {0, 0}, {1, 0},
       evenly(0));
  hold(shot, {{side, 0.1}, {side, 0.15}, {side, 0.2}}, {high, 0}, {0, 1}, first);
  hold(shot, {{0, 0.1}, {0, 0.15}, {0, 0.2}}, {low, 0}, {0, -1}, first);
  hold(shot, {{0.1, side}, {0.15, side}, {0.2, side}}, {0, high}, {-1, 0}, second);
  hold(shot, {{0.1, 0}, {0.15, 0}, {0.2, 0}}, {0, low}, {1, 0}, second);
  return shot;
}

Turn late(double angle) {
  return [=](double share) { return angle * std::max(0.0, 2 * share - 1); };
}

std::vector<ExpectedCrease> gussets_of(const Shot& shot) {
  std::vector<ExpectedCrease> found;
  for (const ExpectedCrease& crease : expected_creases(shot, 1))
    if (crease.by == ExpectedCrease::By::folds_that_cross) found.push_back(crease);
  return found;
}

TEST(GussetsTest, ASheetThatIsWrappedRoundABoxHasOneAtEachCorner) {
  const Shot shot = wrapped(evenly(90 * degrees), late(90 * degrees));
  EXPECT_EQ(expected_creases(shot, 1).size(), 8u);
  const std::vector<ExpectedCrease> found = gussets_of(shot);
  ASSERT_EQ(found.size(), 4u);
  for (int k = 0; k < 4; ++k) {
    int here = 0;
    for (const ExpectedCrease& gusset : found) {
      if ((gusset.line.a - crossings[k]).norm() > 1e-6) continue;
      ++here;
      EXPECT_EQ(gusset.line.b, corners[k]);
      EXPECT_EQ(gusset.missing.size(), 1u);
      for (int f = 0; f < frames; ++f) {
        // the second sides have not begun; or layers come to lie on each other
        const bool turns = f > frames / 2 && f < frames - 1;
        EXPECT_EQ(std::isnan(gusset.turn[f]), !turns) << f;
        if (turns) {
          EXPECT_GT(gusset.turn[f], 0) << "outwards, as its lines";
        }
      }
    }
    EXPECT_EQ(here, 1) << k;
  }
}

TEST(GussetsTest, ThereIsNoneWherePaperCanBeFoldedStraightOn) {
  EXPECT_TRUE(gussets_of(wrapped(evenly(90 * degrees), evenly(0))).empty());
  EXPECT_TRUE(gussets_of(wrapped(evenly(90 * degrees), evenly(-90 * degrees))).empty())
      << "it would have to stretch";
  // the first fold is shut before the second begins
  const Turn first = [](double share) { return std::min(1.0, 2 * share) * 178 * degrees; };
  Shot shot = test::blank_shot(test::rectangle(side, side));
  hold(shot, {{0.05, 0.05}, {0.1, 0.05}, {0.05, 0.1}}, {0, 0}, {1, 0}, evenly(0));
  hold(shot, {{0.25, 0.05}, {0.2, 0.05}, {0.25, 0.1}}, {0.15, 0}, {0, 1}, first);
  hold(shot, {{0.05, 0.25}, {0.1, 0.25}, {0.05, 0.2}}, {0, 0.15}, {-1, 0}, late(178 * degrees));
  EXPECT_EQ(expected_creases(shot, 1).size(), 2u);
  EXPECT_TRUE(gussets_of(shot).empty());
}

TEST(GussetsTest, HandlesInACornerSayToWhichSideItGoes) {
  for (const bool outwards : {true, false}) {
    Shot shot = wrapped(evenly(80 * degrees), evenly(80 * degrees));
    Handle tip = test::bare_handle("handle.tip", {side, side}, frames);
    for (int f = 1; f < frames; ++f) {
      const double turn = f / (frames - 1.0) * 80 * degrees;
      const Vector3d way = gusset_shape(90 * degrees, turn, turn, outwards)->bisector;
      tip.keyed.row(f) = Vector3d(high, high, 0) + std::sqrt(2) * (side - high) * way;
    }
    shot.handles.push_back(tip);
    int here = 0;
    for (const ExpectedCrease& gusset : gussets_of(shot)) {
      if (gusset.line.b != corners[2]) {
        EXPECT_GT(largest_turn(gusset), 0) << "the others go outwards";
        continue;
      }
      ++here;
      EXPECT_EQ(largest_turn(gusset) > 0, outwards);
    }
    EXPECT_EQ(here, 1);
  }
}

TEST(GussetsTest, AHandThatHoldsTheCornerFoldsItItself) {
  // a map whose quarters are folded at the same time
  const Vector2d middle(side / 2, side / 2), along_y(0, 1), along_x(-1, 0);
  const Turn turn = evenly(120 * degrees);
  Shot shot = test::blank_shot(test::rectangle(side, side));
  hold(shot, {{0.05, 0.05}, {0.1, 0.05}, {0.05, 0.1}}, middle, along_y, evenly(0));
  hold(shot, {{0.25, 0.05}, {0.2, 0.05}, {0.25, 0.1}}, middle, along_y, turn);
  hold(shot, {{0.05, 0.25}, {0.1, 0.25}, {0.05, 0.2}}, middle, along_x, turn);
  EXPECT_EQ(gussets_of(shot).size(), 1u) << "nobody holds the last quarter";
  hold(shot, {{0.25, 0.25}, {0.2, 0.25}, {0.25, 0.2}}, [&](double share) {
    return turned(turn(share), middle, along_y) * turned(turn(share), middle, along_x);
  });
  EXPECT_EQ(expected_creases(shot, 1).size(), 2u);
}

/// A mesh with edges on all lines: nine cells of two triangles.
Sheet mesh_of_lines() {
  constexpr double at[] = {0, low, high, side};
  Points2 pattern(16, 2);
  for (int v = 0; v < 16; ++v) pattern.row(v) << at[v % 4], at[v / 4];
  Triangles triangles(18, 3);
  for (int k = 0; k < 9; ++k) {
    const int v = k / 3 * 4 + k % 3;
    if ((k % 3 == 2) != (k / 3 == 2)) {  // the gussets of these cells go down to the right
      triangles.row(2 * k) << v, v + 1, v + 4;
      triangles.row(2 * k + 1) << v + 1, v + 5, v + 4;
    } else {
      triangles.row(2 * k) << v, v + 1, v + 5;
      triangles.row(2 * k + 1) << v, v + 5, v + 4;
    }
  }
  return test::flat_sheet(pattern, triangles);
}

TEST(GussetsTest, BeyondACrossingTheLinesTurnAsPaperMustAndAreNotPressedByTheirHands) {
  Shot shot = wrapped(evenly(80 * degrees), late(80 * degrees));
  add_expected_creases(shot, expected_creases(shot, 1));
  Sheet sheet = mesh_of_lines();
  sheet.prescribed_creases = shot.pattern.prescribed_creases;
  const int row = 3 * frames / 4;
  fold_by_hands(sheet, shot.hands, row);
  const double first = 80 * degrees * row / (frames - 1.0),
               second = 80 * degrees * (2.0 * row / (frames - 1) - 1);
  const auto shape = gusset_shape(90 * degrees, first, second, true);
  int along[2] = {0, 0}, beyond[2] = {0, 0};
  for (const CreaseEdge& edge : sheet.crease_edges) {
    const Vector2d at = 0.5 * (edge.a + edge.b);
    ASSERT_TRUE(edge.folded && edge.pressed) << at.transpose();
    for (int k = 0; k < 2; ++k) {  // lines across x are those of the first sides
      if (std::abs(edge.a[k] - edge.b[k]) > 1e-9) continue;
      const bool inside = at[1 - k] > low && at[1 - k] < high;
      ++(inside ? along : beyond)[k];
      EXPECT_NEAR(*edge.pressed, inside ? (k == 0 ? first : second) : shape->beyond[k], 1e-6);
    }
  }
  for (int k = 0; k < 2; ++k) {
    EXPECT_GT(along[k], 0);
    EXPECT_GT(beyond[k], 0);
  }
}

TEST(GussetsTest, BeyondAFoldThatWasLetGoNobodyPressesTheOthersStraightOn) {
  Shot shot = wrapped(evenly(80 * degrees), late(80 * degrees));
  add_expected_creases(shot, expected_creases(shot, 1));
  const auto is_along_x = [&](const FoldingHands& hands) {
    return std::abs(hands.line.a.y() - hands.line.b.y()) < 1e-9;
  };
  const int row = frames - 1;
  for (FoldingHands& hands : shot.hands)
    if (hands.beyond || is_along_x(hands))
      hands.turn[row] = std::numeric_limits<double>::quiet_NaN();
  Sheet sheet = mesh_of_lines();
  sheet.prescribed_creases = shot.pattern.prescribed_creases;
  fold_by_hands(sheet, shot.hands, row);
  int held = 0, free = 0;
  for (const CreaseEdge& edge : sheet.crease_edges) {
    if (std::abs(edge.a.x() - edge.b.x()) > 1e-9) continue;
    const double y = 0.5 * (edge.a.y() + edge.b.y());
    const bool inside = y > low && y < high;
    ++(inside ? held : free);
    EXPECT_EQ(edge.pressed.has_value(), inside) << y;
  }
  EXPECT_EQ(held, 2);
  EXPECT_EQ(free, 4);
}

}  // namespace
}  // namespace paperbake
