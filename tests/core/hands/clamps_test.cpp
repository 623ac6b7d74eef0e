#include "core/hands/clamps.h"

#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>

namespace paperbake {
namespace {

constexpr int rows = 20, first_frame = 5;
constexpr double side = 0.2;  // [m]

/// A sheet of 0.2 m with handles at these places, which stay where they hold it.
Shot shot_with(const std::vector<Vector2d>& places) {
  Shot shot = test::blank_shot(test::rectangle(side, 0.15));
  for (const Vector2d& p : places)
    shot.handles.push_back(
        test::bare_handle("handle." + std::to_string(shot.handles.size()), p, rows));
  return shot;
}

/// The turn about the line of the flat sheet at this x. [m]
Eigen::Isometry3d turned(double angle, double x) {
  const Eigen::Translation3d there(x, 0, 0);
  return Eigen::Isometry3d(there * Eigen::AngleAxisd(angle, Vector3d::UnitY()) * there.inverse());
}

/// Turns some handles about such a line by up to this angle. [rad]
void turn(Shot& shot, const std::vector<int>& handles, double angle, double x = 0.1) {
  for (const int h : handles)
    for (int row = 0; row < rows; ++row)
      shot.handles[h].keyed.row(row) = turned(angle * row / (rows - 1), x) *
                                       Vector3d(shot.handles[h].keyed.row(row).transpose());
}

using Found = std::vector<std::pair<std::vector<int>, bool>>;

/// Handles of all clamps, in order, and whether each is a plate.
Found found(const Shot& shot) {
  const Clamps clamps(shot, first_frame);
  Found all;
  for (const Clamp& clamp : clamps.all()) all.emplace_back(clamp.handles, clamp.is_plate);
  std::sort(all.begin(), all.end());
  return all;
}

const std::vector<Vector2d> left{{0.01, 0.02}, {0.01, 0.13}, {0.06, 0.07}},
    right{{0.15, 0.02}, {0.15, 0.13}, {0.19, 0.07}};

std::vector<Vector2d> both(std::vector<Vector2d> places = {}) {
  places.insert(places.begin(), right.begin(), right.end());
  places.insert(places.begin(), left.begin(), left.end());
  return places;
}

TEST(ClampsTest, HandlesThatKeepTheirDistancesAreOnePlate) {
  Shot shot = shot_with(both());
  EXPECT_EQ(found(shot), (Found{{{0, 1, 2, 3, 4, 5}, true}})) << "all of them stay";
  turn(shot, {3, 4, 5}, 2);
  EXPECT_EQ(found(shot), (Found{{{0, 1, 2}, true}, {{3, 4, 5}, true}}));
}

TEST(ClampsTest, AHandleOnTheFoldBelongsToBothPlates) {
  Shot shot = shot_with(both({{0.1, 0.02}, {0.1, 0.09}}));
  turn(shot, {3, 4, 5}, 2);  // the two on the line stay while these turn with them
  EXPECT_EQ(found(shot), (Found{{{0, 1, 2, 6, 7}, true}, {{3, 4, 5, 6, 7}, true}}));
}

TEST(ClampsTest, ThePlateBetweenTwoFoldsIsFoundBySidesThatAreNearerToOthers) {
  Shot shot = shot_with({{0.01, 0.02},
                         {0.01, 0.13},
                         {0.05, 0.02},
                         {0.05, 0.13},
                         {0.15, 0.02},
                         {0.15, 0.13},
                         {0.19, 0.02},
                         {0.19, 0.13}});
  turn(shot, {0, 1}, 2, 0.05);
  turn(shot, {6, 7}, 2, 0.15);
  EXPECT_EQ(found(shot), (Found{{{0, 1, 2, 3}, true}, {{2, 3, 4, 5}, true}, {{4, 5, 6, 7}, true}}));
}

TEST(ClampsTest, HandlesInALineAreARowAndNoPlate) {
  constexpr double narrow = 0.01 * side, wide = 0.04 * side;
  EXPECT_EQ(found(shot_with({{0.1, 0.02}, {0.1, 0.13}})), (Found{{{0, 1}, false}}));
  EXPECT_EQ(found(shot_with({{0.1, 0.02}, {0.1, 0.13}, {0.1 + narrow, 0.08}})),
            (Found{{{0, 1, 2}, false}}));
  EXPECT_EQ(found(shot_with({{0.1, 0.02}, {0.1, 0.13}, {0.1 + wide, 0.08}})),
            (Found{{{0, 1, 2}, true}}));
}

TEST(ClampsTest, HandlesThatAreTooNearToEachOtherSayNothing) {
  // the root of the summed squares of the distances from their middle is to be 5 % of the side
  const double least = std::sqrt(2.0) * 0.05 * side;
  EXPECT_TRUE(found(shot_with({{0.1, 0.1}, {0.1 + 0.99 * least, 0.1}})).empty());
  EXPECT_EQ(found(shot_with({{0.1, 0.1}, {0.1 + 1.01 * least, 0.1}})), (Found{{{0, 1}, false}}));
  EXPECT_TRUE(found(shot_with({{0.1, 0.1}})).empty());
}

TEST(ClampsTest, DistancesAreKeptToATwoThousandthOfTheLongerSide) {
  for (const double share : {0.9, 1.1}) {
    Shot shot = shot_with({{0.05, 0.05}, {0.15, 0.05}});
    for (const double sign : {-1.0, 1.0}) {
      shot.handles[1].keyed(7, 0) = 0.15 + sign * share * 2e-3 * side;
      EXPECT_EQ(found(shot).size(), share < 1 ? 1u : 0u) << sign * share;
    }
  }
}

TEST(ClampsTest, AHandThatTakesOverFromAnotherIsNoPartOfIt) {
  const auto overlapping = [](int frames) {
    Shot shot = shot_with(both());
    for (int h = 0; h < 6; ++h) {
      if (h < 3) shot.handles[h].release_frame = first_frame + 10;
      if (h >= 3) shot.handles[h].grab_frame = first_frame + 10 - frames;
    }
    return found(shot);
  };
  const Found apart{{{0, 1, 2}, true}, {{3, 4, 5}, true}}, one{{{0, 1, 2, 3, 4, 5}, true}};
  EXPECT_EQ(overlapping(0), apart) << "they never hold together";
  EXPECT_EQ(overlapping(4), apart);
  EXPECT_EQ(overlapping(5), one) << "half of the ten frames of the first";
}

TEST(ClampsTest, WhatHandlesDoAfterTheyLetGoDoesNotMatter) {
  Shot shot = shot_with(both());
  turn(shot, {3, 4, 5}, 2);
  for (int h = 0; h < 6; ++h) shot.handles[h].release_frame = first_frame + 1;
  EXPECT_EQ(found(shot), (Found{{{0, 1, 2, 3, 4, 5}, true}}));
}

TEST(ClampsTest, AHandleThatNeverHoldsIsInNoClamp) {
  Shot shot = shot_with(both());
  shot.handles[1].grab_frame = first_frame + rows;
  EXPECT_EQ(found(shot), (Found{{{0, 2, 3, 4, 5}, true}}));
}

TEST(ClampsTest, RelativeHandlesAreInNoClamp) {
  Shot shot = shot_with(both({{0.1, 0.1}}));
  shot.handles[2].mode = shot.handles[6].mode = HandleMode::relative;
  EXPECT_EQ(found(shot), (Found{{{0, 1, 3, 4, 5}, true}}));
  EXPECT_EQ(Clamps(shot, first_frame).absolute(), (std::vector<int>{0, 1, 3, 4, 5}));
}

TEST(ClampsTest, KeysOfDifferentLengthsGoOnAsTheyEnd) {
  Shot shot = shot_with(both());
  for (int h = 0; h < 6; ++h)
    shot.handles[h].keyed = Points3(shot.handles[h].keyed.topRows(h == 4 ? 12 : 3));
  const Clamps clamps(shot, first_frame);
  EXPECT_EQ(clamps.rows(), 12);
  EXPECT_EQ(clamps.all().size(), 1u);
  EXPECT_EQ(clamps.keyed(0, 11), Vector3d(left[0].x(), left[0].y(), 0));
}

TEST(ClampsTest, ThePoseOfAClampTakesThePatternToWhereItsHandlesAre) {
  Shot shot = shot_with(both());
  turn(shot, {3, 4, 5}, 2);
  shot.handles[4].grab_frame = first_frame + 3;
  const Clamps clamps(shot, first_frame);
  ASSERT_EQ(clamps.all().size(), 2u);
  const Clamp& moving = clamps.all()[1];
  ASSERT_EQ(moving.handles, (std::vector<int>{3, 4, 5}));
  EXPECT_LT((clamps.middle(moving) - (right[0] + right[1] + right[2]) / 3).norm(), 1e-15);
  EXPECT_EQ(clamps.place(5), right[2]);
  EXPECT_DOUBLE_EQ(clamps.side(), side);
  for (int row = 0; row < rows; ++row) {
    const std::optional<RigidMotion> pose = clamps.pose(moving, row);
    ASSERT_EQ(pose.has_value(), row >= 3) << row;
    EXPECT_EQ(clamps.held(4, row), row >= 3);
    if (!pose) continue;
    const Eigen::Isometry3d way = turned(2.0 * row / (rows - 1), 0.1);
    for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(0.1, 0, 0), Vector3d(0, 0.1, 0.1)})
      EXPECT_LT(((*pose)(p)-way * p).norm(), 1e-14) << row;
  }
}

}  // namespace
}  // namespace paperbake
