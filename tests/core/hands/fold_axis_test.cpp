#include "core/hands/fold_axis.h"

#include "core/model/segment2.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <numeric>

namespace paperbake {
namespace {

using Eigen::Isometry3d;
using Way = std::function<Isometry3d(double share)>;  // of the time, from 0 to 1

constexpr int rows = 25, first_frame = 1;

Vector3d on_sheet(const Vector2d& p) { return {p.x(), p.y(), 0}; }

/// The turn about a line of the flat sheet, right-handed about its direction.
Isometry3d turned(double angle, const Line2& line) {
  const Eigen::Translation3d there(on_sheet(line.p));
  return Isometry3d(there * Eigen::AngleAxisd(angle, on_sheet(line.along).normalized()) *
                    there.inverse());
}

Way turning(double angle, const Line2& line) {
  return [=](double share) { return turned(share * angle, line); };
}

Isometry3d still(double) { return Isometry3d::Identity(); }

/// A motion of the whole scene.
Isometry3d carried(double share) {
  return Eigen::Translation3d(0.3 * share, -0.1, share * share) *
         Eigen::AngleAxisd(2 * share, Vector3d(1, 2, -1).normalized());
}

/// Two groups of handles on a sheet of 0.2 m, of which each moves as one body, and what is found
/// between them.
struct TwoHands {
  Shot shot = test::blank_shot(test::rectangle(0.2, 0.2));
  Clamp plate{{}, true}, other{{}, true};

  void hold(Clamp& clamp, const std::vector<Vector2d>& places, const Way& way) {
    for (const Vector2d& p : places) {
      clamp.handles.push_back(static_cast<int>(shot.handles.size()));
      Handle handle = test::bare_handle("handle." + std::to_string(clamp.handles.back()), p, rows);
      for (int row = 0; row < rows; ++row)
        handle.keyed.row(row) = way(row / (rows - 1.0)) * on_sheet(p);
      shot.handles.push_back(handle);
    }
  }
  std::optional<FoldAxis> axis() const { return fold_axis({shot, first_frame}, plate, other); }
  std::optional<FoldAxis> axis_of_other() const {
    return fold_axis({shot, first_frame}, other, plate);
  }
};

const std::vector<Vector2d> left{{0.01, 0.02}, {0.01, 0.18}, {0.06, 0.1}},
    right{{0.15, 0.03}, {0.18, 0.17}, {0.19, 0.1}}, row{{0.17, 0.03}, {0.17, 0.1}, {0.17, 0.17}};

/// A line between them, upwards: `left` is on its left.
const Line2 between{{0.1, 0}, {0.02, 0.2}};

TwoHands hands(const std::vector<Vector2d>& right_places, const Way& way,
               const Way& whole = still) {
  TwoHands two;
  two.hold(two.plate, left, whole);
  two.hold(two.other, right_places, [=](double share) { return whole(share) * way(share); });
  two.other.is_plate = right_places != row;
  return two;
}

/// Expects this line, and the turn of the hands: positive where the fold bulges towards the
/// normals, as where what is on the right of the way up goes down.
void expect_axis(const std::optional<FoldAxis>& axis, const Line2& line, double angle) {
  ASSERT_TRUE(axis);
  EXPECT_NEAR(axis->direction.norm(), 1, 1e-12);
  EXPECT_NEAR(cross(axis->direction, line.along.normalized()), 0, 1e-9);
  EXPECT_NEAR(cross(line.along.normalized(), axis->point - line.p), 0, 1e-9);
  ASSERT_EQ(axis->turn.size(), static_cast<std::size_t>(rows));
  for (int f = 0; f < rows; ++f)
    EXPECT_NEAR(axis->turn[f], angle * f / (rows - 1.0), 1e-7) << "row " << f;
}

TEST(FoldAxisTest, PlatesThatTurnAgainstEachOtherFoldTheLineAboutWhichTheyDo) {
  for (const Way& whole : {Way(still), Way(carried)})
    for (const double angle : {1.1, 2.5, -1.1, -3.0}) {
      const TwoHands two = hands(right, turning(angle, between), whole);
      expect_axis(two.axis(), between, angle);
      expect_axis(two.axis_of_other(), between, angle);
    }
}

TEST(FoldAxisTest, TheLineMayRunInAnyDirection) {
  for (int k = 0; k < 16; ++k) {
    const double angle = 2 * M_PI * k / 16;
    const Eigen::Rotation2Dd round(angle);
    const auto at = [&](const Vector2d& p) -> Vector2d {
      return Vector2d(0.1, 0.1) + round * (p - Vector2d(0.1, 0.1));
    };
    const Line2 line{at(between.p), round * between.along};
    TwoHands two;
    std::vector<Vector2d> one, another;
    for (const Vector2d& p : left) one.push_back(at(p));
    for (const Vector2d& p : right) another.push_back(at(p));
    two.hold(two.plate, one, still);
    two.hold(two.other, another, turning(2, line));
    SCOPED_TRACE(k);
    expect_axis(two.axis(), line, 2);
    EXPECT_GE(two.axis()->direction.x(), 0) << "whichever of the two the rounding prefers";
  }
}

TEST(FoldAxisTest, ATurnGoesOnBeyondHalfATurn) {
  const TwoHands two = hands(right, turning(4, between));
  expect_axis(two.axis(), between, 4);
}

TEST(FoldAxisTest, HandsThatOpenTheFoldAgainFoldItWhereTheyTurnMost) {
  const Way there_and_back = [](double share) {
    return turned(2.5 * std::sin(M_PI * share), between);
  };
  for (const auto& places : {right, row}) {
    const std::optional<FoldAxis> axis = hands(places, there_and_back).axis();
    ASSERT_TRUE(axis);
    for (int f = 0; f < rows; ++f)
      EXPECT_NEAR(axis->turn[f], 2.5 * std::sin(M_PI * f / (rows - 1)), 1e-7) << f;
  }
}

TEST(FoldAxisTest, ARowThatGoesOnAnArcFoldsTheLineInItsMiddle) {
  for (const Way& whole : {Way(still), Way(carried)})
    for (const double angle : {1.1, 2.5, -1.1, -2.9})
      expect_axis(hands(row, turning(angle, between), whole).axis(), between, angle);
  TwoHands rows_only = hands(row, turning(2.5, between));
  rows_only.plate.is_plate = false;
  EXPECT_FALSE(rows_only.axis());
}

TEST(FoldAxisTest, KnowsTheHandsAndWhatIsBetweenThem) {
  const TwoHands two = hands(right, turning(2, between));
  const std::optional<FoldAxis> axis = two.axis();
  ASSERT_TRUE(axis);
  const auto middle = [](const std::vector<Vector2d>& places) -> Vector2d {
    return std::accumulate(places.begin(), places.end(), Vector2d(0, 0)) / places.size();
  };
  EXPECT_LT((axis->between - (middle(left) + middle(right)) / 2).norm(), 1e-15);
  EXPECT_NEAR(axis->reach, (middle(right) - middle(left)).norm(), 1e-15);
  EXPECT_EQ(axis->plate, &two.plate);
  EXPECT_EQ(axis->other, &two.other);
  EXPECT_GT(axis->side(left[0]) * -axis->side(right[0]), 0);
  const Vector2d on_its_left(-axis->direction.y(), axis->direction.x());
  EXPECT_NEAR(axis->side(axis->point + 0.03 * on_its_left + 0.5 * axis->direction), 0.03, 1e-15);
}

TEST(FoldAxisTest, ATurnOfLessThanSixtyDegreesIsNone) {
  for (const double sign : {-1.0, 1.0})
    for (const auto& places : {right, row}) {
      EXPECT_TRUE(hands(places, turning(sign * radians_of(60.5), between)).axis());
      EXPECT_FALSE(hands(places, turning(sign * radians_of(59.5), between)).axis());
    }
}

TEST(FoldAxisTest, TheTurnIsNotKnownWhereAHandleDoesNotHold) {
  for (const auto& places : {right, row}) {
    TwoHands two = hands(places, turning(2, between));
    two.shot.handles[1].release_frame = first_frame + 20;
    two.shot.handles[4].grab_frame = first_frame + 3;
    const std::optional<FoldAxis> axis = two.axis();
    ASSERT_TRUE(axis);
    for (int f = 0; f < rows; ++f) EXPECT_EQ(std::isnan(axis->turn[f]), f < 3 || f >= 20) << f;
  }
}

TEST(FoldAxisTest, AClampOnBothSidesOrBothOnOneSideFoldNothing) {
  const Line2 through{{0.17, 0}, {0, 0.2}}, beyond{{0.25, 0}, {0, 0.2}};
  EXPECT_FALSE(hands(right, turning(2, through)).axis());
  EXPECT_FALSE(hands(right, turning(2, beyond)).axis());
}

TEST(FoldAxisTest, AHandleOfOneSideMayBeOnTheLineButNotBeyondIt) {
  // beyond it by half a per cent of the longer side, whichever side that is
  const auto reaches = [](bool upright, bool from_right, double across) {
    const auto at = [=](const Vector2d& p) { return upright ? p : Vector2d(p.y(), p.x()); };
    std::vector<Vector2d> one = left, another = right;
    if (from_right) std::swap(one, another);
    another.emplace_back(from_right ? 0.1 + across : 0.1 - across, 0.1);
    for (auto* places : {&one, &another})
      for (Vector2d& p : *places) p = at(p);
    TwoHands two;
    two.hold(two.plate, one, still);
    two.hold(two.other, another, turning(2, {at({0.1, 0}), at({0, 0.2})}));
    return two.axis().has_value();
  };
  for (const bool upright : {false, true})
    for (const bool from_right : {false, true}) {
      EXPECT_TRUE(reaches(upright, from_right, 0.9 * 5e-3 * 0.2)) << upright << from_right;
      EXPECT_FALSE(reaches(upright, from_right, 1.1 * 5e-3 * 0.2)) << upright << from_right;
    }
}

/// A turn about the line between the hands, and along it. slide  [m]
Way screw(double slide, double angle = 2) {
  return [=](double share) -> Isometry3d {
    return Eigen::Translation3d(slide * share * on_sheet(between.along.normalized())) *
           turned(angle * share, between);
  };
}

TEST(FoldAxisTest, APlateThatSlidesAlongTheLineFoldsNothing) {
  EXPECT_TRUE(hands(right, screw(1e-5)).axis());
  EXPECT_FALSE(hands(right, screw(0.02)).axis());
  EXPECT_FALSE(hands(row, screw(0.02)).axis());
}

TEST(FoldAxisTest, TheTurnIsNotKnownWhereThePaperWouldMissTheLine) {
  // by more than 2 % of the longer side; a sheet that is bent by 3 radians might miss it by more
  constexpr double most = 0.02 * 0.2, slide = 1.12 * most;
  const std::optional<FoldAxis> axis = hands(right, screw(slide, 3)).axis();
  ASSERT_TRUE(axis);
  for (int f = 0; f < rows; ++f)
    EXPECT_EQ(std::isnan(axis->turn[f]), slide * f / (rows - 1) > most) << "row " << f;
}

TEST(FoldAxisTest, APlateThatTurnsAboutALineOutOfTheSheetFoldsNothing) {
  // both agree in one point, as they would about a pin
  const Way about_a_pin = [](double share) -> Isometry3d {
    return Eigen::Translation3d(0.1, 0.1, 0) *
           Eigen::AngleAxisd(2 * share, Vector3d(0, 1, 0.5).normalized()) *
           Eigen::Translation3d(-0.1, -0.1, 0);
  };
  EXPECT_FALSE(hands(right, about_a_pin).axis());
}

TEST(FoldAxisTest, APlateAtTheEndOfASheetThatBendsEvenlyFoldsNothing) {
  // from x = 0.07 to 0.14 the sheet is an arc of a circle, beyond it goes on straight
  constexpr double begin = 0.07, end = 0.14;
  const Way bending = [](double share) -> Isometry3d {
    const double angle = 2 * share + 1e-9, radius = (end - begin) / angle;
    return Eigen::Translation3d(begin + radius * std::sin(angle), 0,
                                -radius * (1 - std::cos(angle))) *
           Eigen::AngleAxisd(angle, Vector3d::UnitY()) * Eigen::Translation3d(-end, 0, 0);
  };
  for (const auto& places : {right, row}) EXPECT_FALSE(hands(places, bending).axis());
}

TEST(FoldAxisTest, HandlesThatArePushedTogetherInThePlaneFoldNothing) {
  const Way pushed = [](double share) -> Isometry3d {
    return Isometry3d(Eigen::Translation3d(-0.1 * share, 0, 0.001 * share));
  };
  const Way at_once = [=](double share) { return share < 1 ? still(share) : pushed(share); };
  for (const Way& way : {pushed, at_once})
    for (const auto& places : {right, row}) EXPECT_FALSE(hands(places, way).axis());
}

}  // namespace
}  // namespace paperbake
