#include "core/hands/handle_feasibility.h"

#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace paperbake {
namespace {

using test::bare_handle;
using test::rectangle;

constexpr double exact = 1e-12;   // [m] sums of a few square roots in double precision
constexpr double settled = 2e-9;  // [m] project() stops at an overshoot of 1e-9
constexpr int first_frame = 10;   // of all shots here

/// A handle at the border x = 0 that rests, and one at the border x = side that is too far out by
/// `away` in each frame.
std::vector<Handle> pulled_apart(double side, const std::vector<double>& away) {
  const int frames = static_cast<int>(away.size());
  std::vector<Handle> handles = {bare_handle("left", {0, side / 2}, frames),
                                 bare_handle("right", {side, side / 2}, frames)};
  for (int f = 0; f < frames; ++f) handles[1].keyed(f, 0) += away[f];
  return handles;
}

std::vector<UnreachablePair> pairs_of(const Pattern& pattern, const std::vector<Handle>& handles,
                                      int last_frame) {
  return HandleFeasibility(pattern, handles).impossible_pairs(handles, first_frame, last_frame);
}

std::vector<int> all_of(const std::vector<Handle>& handles) {
  std::vector<int> all(handles.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// By how much the worst pair is farther apart than the paper, stretched by the tolerance and with
/// rounding, is long. [m]
double worst_overshoot(const Pattern& pattern, const std::vector<Handle>& handles,
                       const Points3& targets) {
  double worst = 0;
  for (std::size_t i = 0; i < handles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      worst =
          std::max(worst, (targets.row(i) - targets.row(j)).norm() -
                              (1 + HandleFeasibility::tolerance) *
                                  paper_distance(pattern, handles[i].pattern, handles[j].pattern) -
                              HandleFeasibility::rounding);
  return worst;
}

// A sheet of 0.1 m with a slot from above, 0.02 m wide and 0.08 m deep. The tips are 0.06 m apart,
// but the paper between them goes down one side of the slot, along its bottom and up the other
// side.
const Pattern u_shape{
    {{0, 0}, {0.1, 0}, {0.1, 0.1}, {0.06, 0.1}, {0.06, 0.02}, {0.04, 0.02}, {0.04, 0.1}, {0, 0.1}},
    {}};
const Vector2d left_tip(0.02, 0.1), right_tip(0.08, 0.1);
const double round_the_slot = 2 * std::hypot(0.02, 0.08) + 0.02;

/// Handles at random points of the pattern, and targets anywhere in a cube of three times its size.
struct Mess {
  std::vector<Handle> handles;
  Points3 targets;
};
Mess mess(const Pattern& pattern, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> on_sheet(0, longer_side(pattern)),
      in_space(0, 3 * longer_side(pattern));
  Mess mess;
  mess.targets.resize(count, 3);
  while (static_cast<int>(mess.handles.size()) < count) {
    const double y = on_sheet(random), x = on_sheet(random);  // in this order for every compiler
    if (const Vector2d p(x, y); contains(pattern, p))
      mess.handles.push_back(bare_handle("h", p, 1));
  }
  for (int k = 0; k < count; ++k)
    mess.targets.row(k) << in_space(random), in_space(random), in_space(random);
  return mess;
}

TEST(HandleFeasibilityTest, ImpossiblePairsAreReportedWithFramesAndWorstOvershoot) {
  // 0.04 mm of 100 mm is below the tolerance of 0.05 mm
  const auto pairs =
      pairs_of(rectangle(0.1, 0.1), pulled_apart(0.1, {0, 0.00004, 0.001, 0.003, 0.002, 0, 0}), 16);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].a, "left");
  EXPECT_EQ(pairs[0].b, "right");
  EXPECT_EQ(pairs[0].first, 12);
  EXPECT_EQ(pairs[0].frame, 13);
  EXPECT_EQ(pairs[0].last, 14);
  EXPECT_NEAR(pairs[0].apart, 0.103, exact);
  EXPECT_NEAR(pairs[0].allowed, 0.1, exact);
}

TEST(HandleFeasibilityTest, APairStaysImpossibleWhileAHandleRestsAfterItsLastKey) {
  const auto pairs = pairs_of(rectangle(0.1, 0.1), pulled_apart(0.1, {0, 0.001}), 40);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].first, 11);
  EXPECT_EQ(pairs[0].last, 40);
}

TEST(HandleFeasibilityTest, PairsAreCheckedUpToTheLastFrameOnly) {
  EXPECT_TRUE(pairs_of(rectangle(0.1, 0.1), pulled_apart(0.1, {0, 0, 0.01}), 11).empty());
  EXPECT_EQ(pairs_of(rectangle(0.1, 0.1), pulled_apart(0.1, {0, 0, 0.01}), 12).size(), 1u);
}

TEST(HandleFeasibilityTest, TheWorstPairComesFirst) {
  std::vector<Handle> handles = pulled_apart(0.1, {0, 0.001});
  handles.push_back(bare_handle("far", {0.1, 0.1}, 2));
  handles[2].keyed(1, 0) += 0.02;
  const auto pairs = pairs_of(rectangle(0.1, 0.1), handles, 11);
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_EQ(pairs[0].a + " " + pairs[0].b, "left far");
  EXPECT_EQ(pairs[1].a + " " + pairs[1].b, "right far");
  EXPECT_EQ(pairs[2].a + " " + pairs[2].b, "left right");
  EXPECT_NEAR(pairs[0].apart - pairs[0].allowed, std::hypot(0.12, 0.05) - std::hypot(0.1, 0.05),
              exact);
  EXPECT_NEAR(pairs[2].apart - pairs[2].allowed, 0.001, exact);
}

TEST(HandleFeasibilityTest, RelativeAndSoftHandlesAreNotChecked) {
  for (const int which : {0, 1}) {
    std::vector<Handle> handles = pulled_apart(0.1, {0, 0.01});
    ASSERT_EQ(pairs_of(rectangle(0.1, 0.1), handles, 11).size(), 1u);
    handles[which].mode = HandleMode::relative;
    EXPECT_TRUE(pairs_of(rectangle(0.1, 0.1), handles, 11).empty());
    handles[which].mode = HandleMode::absolute;
    handles[which].stiffness = 100;
    EXPECT_TRUE(pairs_of(rectangle(0.1, 0.1), handles, 11).empty());
  }
}

TEST(HandleFeasibilityTest, HandlesHeldAtDifferentTimesAreNoPair) {
  std::vector<Handle> handles = pulled_apart(0.1, {0.01, 0.01, 0.01, 0.01});
  handles[0].release_frame = 12;  // held in frames 10 and 11
  handles[1].grab_frame = 12;
  EXPECT_TRUE(pairs_of(rectangle(0.1, 0.1), handles, 13).empty());
  handles[1].grab_frame = 11;  // one frame in common
  const auto pairs = pairs_of(rectangle(0.1, 0.1), handles, 13);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].first, 11);
  EXPECT_EQ(pairs[0].last, 11);
}

TEST(HandleFeasibilityTest, WhatNobodySeesIsNotTold) {
  // 3 um of 3 mm: more than the tolerance of 0.05 %
  std::vector<Handle> handles = {bare_handle("a", {0.05, 0.05}, 1),
                                 bare_handle("b", {0.053, 0.05}, 1)};
  handles[1].keyed(0, 0) += 3e-6;
  EXPECT_TRUE(pairs_of(rectangle(0.1, 0.1), handles, first_frame).empty());
  handles[1].keyed(0, 0) += 2e-5;
  EXPECT_EQ(pairs_of(rectangle(0.1, 0.1), handles, first_frame).size(), 1u);
}

TEST(HandleFeasibilityTest, TwoHandlesOnOnePointMayDifferByTheRoundingOfTheFile) {
  std::vector<Handle> handles = {bare_handle("a", {0.05, 0.05}, 1),
                                 bare_handle("b", {0.05, 0.05}, 1)};
  handles[1].keyed(0, 0) += 6e-8;  // rounding of 32-bit numbers near 1 m
  EXPECT_TRUE(pairs_of(rectangle(0.1, 0.1), handles, first_frame).empty());
  handles[1].keyed(0, 0) += 1e-3;
  EXPECT_EQ(pairs_of(rectangle(0.1, 0.1), handles, first_frame).size(), 1u);
}

TEST(HandleFeasibilityTest, TheTipsOfAUMayBeAsFarApartAsThePaperBetweenThemIsLong) {
  std::vector<Handle> handles = {bare_handle("left", left_tip, 1),
                                 bare_handle("right", right_tip, 1)};
  // three times the straight distance
  handles[1].keyed(0, 0) = left_tip.x() + round_the_slot - 0.001;
  EXPECT_TRUE(pairs_of(u_shape, handles, first_frame).empty());
  handles[1].keyed(0, 0) += 0.002;
  const auto pairs = pairs_of(u_shape, handles, first_frame);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_NEAR(pairs[0].allowed, round_the_slot, exact);
}

TEST(HandleFeasibilityTest, ProjectionLeavesPossibleTargetsUntouchedToTheLastBit) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Mess m = mess(rectangle(0.1, 0.1), 12, seed);
    // The flat sheet is turned in space, then made smaller: no pair is farther apart than on the
    // pattern.
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.3 * seed, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    for (const double size : {1.0, 0.7}) {
      for (int k = 0; k < 12; ++k) {
        const Vector3d flat(m.handles[k].pattern.x(), size * m.handles[k].pattern.y(), 0);
        m.targets.row(k) = (turn * flat).transpose() + Eigen::RowVector3d(3, -1, 2);
      }
      Points3 after = m.targets;
      EXPECT_EQ(HandleFeasibility(rectangle(0.1, 0.1), m.handles).project(all_of(m.handles), after),
                0);
      EXPECT_TRUE(after == m.targets);
    }
  }
}

TEST(HandleFeasibilityTest, ProjectionLeavesTheTipsOfAUWherePaperCanReach) {
  const std::vector<Handle> handles = {bare_handle("left", left_tip, 1),
                                       bare_handle("right", right_tip, 1)};
  Points3 targets(2, 3);
  targets << 0, 0, 0, round_the_slot, 0, 0;
  const Points3 asked = targets;
  EXPECT_EQ(HandleFeasibility(u_shape, handles).project({0, 1}, targets), 0);
  EXPECT_TRUE(targets == asked);
  targets(1, 0) = 2 * round_the_slot;
  EXPECT_GT(HandleFeasibility(u_shape, handles).project({0, 1}, targets), 0);
  EXPECT_NEAR(worst_overshoot(u_shape, handles, targets), 0, settled);
}

TEST(HandleFeasibilityTest, ProjectionMakesImpossibleTargetsPossible) {
  for (const Pattern& pattern : {rectangle(0.1, 0.1), rectangle(0.3, 0.03), u_shape})
    for (const int count : {2, 3, 7, 20})
      for (unsigned seed = 1; seed <= 8; ++seed) {
        Mess m = mess(pattern, count, seed);
        ASSERT_GT(worst_overshoot(pattern, m.handles, m.targets), 0.01);
        EXPECT_GT(HandleFeasibility(pattern, m.handles).project(all_of(m.handles), m.targets),
                  0.005);
        EXPECT_LT(worst_overshoot(pattern, m.handles, m.targets), settled)
            << count << " handles, seed " << seed;
      }
}

TEST(HandleFeasibilityTest, ProjectionMakesAStretchedRowPossible) {
  // A border of 11 handles is drawn out to twice its length, and two such borders are drawn apart:
  // every pair ends at its limit.
  std::vector<Handle> handles;
  for (int i = 0; i <= 10; ++i)
    for (const double side : {0.0, 0.1}) handles.push_back(bare_handle("h", {side, 0.01 * i}, 1));
  Points3 targets(handles.size(), 3);
  for (std::size_t k = 0; k < handles.size(); ++k)
    targets.row(k) << 2 * handles[k].pattern.x(), 2 * handles[k].pattern.y(), 0;
  HandleFeasibility(rectangle(0.1, 0.1), handles).project(all_of(handles), targets);
  EXPECT_LT(worst_overshoot(rectangle(0.1, 0.1), handles, targets), settled);
}

TEST(HandleFeasibilityTest, ProjectionReturnsTheLargestDisplacement) {
  Mess m = mess(rectangle(0.1, 0.1), 7, 5);
  const Points3 asked = m.targets;
  const double moved =
      HandleFeasibility(rectangle(0.1, 0.1), m.handles).project(all_of(m.handles), m.targets);
  EXPECT_NEAR(moved, std::sqrt((m.targets - asked).rowwise().squaredNorm().maxCoeff()), exact);
}

TEST(HandleFeasibilityTest, ProjectionKeepsTheCentreOfTheTargets) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Mess m = mess(rectangle(0.1, 0.1), 9, seed);
    const Eigen::RowVector3d centre = m.targets.colwise().mean();
    HandleFeasibility(rectangle(0.1, 0.1), m.handles).project(all_of(m.handles), m.targets);
    EXPECT_LT((m.targets.colwise().mean() - centre).norm(), exact) << "seed " << seed;
  }
}

TEST(HandleFeasibilityTest, ProjectionMovesBothHandlesOfAPairByTheSameDistance) {
  const std::vector<Handle> handles = {bare_handle("a", {0, 0}, 1),
                                       bare_handle("b", {0.06, 0.08}, 1)};
  Points3 targets(2, 3);
  targets << 1, 2, 3, 1.3, 2.4, 3.2;
  const Points3 asked = targets;
  const double moved = HandleFeasibility(rectangle(0.1, 0.1), handles).project({0, 1}, targets);
  EXPECT_NEAR((targets.row(0) - targets.row(1)).norm(), 0.1 * (1 + HandleFeasibility::tolerance),
              HandleFeasibility::rounding + settled);
  EXPECT_LT((targets.row(0) - asked.row(0) + targets.row(1) - asked.row(1)).norm(), exact);
  EXPECT_NEAR((targets.row(0) - asked.row(0)).norm(), moved, exact);
  EXPECT_LT((targets.row(0) - targets.row(1))
                .normalized()
                .cross((asked.row(0) - asked.row(1)).normalized())
                .norm(),
            exact);
}

TEST(HandleFeasibilityTest, ProjectionKeepsASmallChangeOfTheTargetsSmall) {
  // Every correction of a pair is the projection on a convex set, which moves no two inputs farther
  // apart; what is left over after the last sweep is 1e-9 per pair.
  constexpr double change = 1e-5;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Mess m = mess(rectangle(0.1, 0.1), 8, seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-change, change);
    Points3 near = m.targets;
    for (int k = 0; k < near.size(); ++k) near.data()[k] += uniform(random);
    const double before = (near - m.targets).norm();
    ASSERT_GT(before, change);
    const HandleFeasibility reach(rectangle(0.1, 0.1), m.handles);
    reach.project(all_of(m.handles), m.targets);
    reach.project(all_of(m.handles), near);
    EXPECT_LT((near - m.targets).norm(), before + 28 * settled) << "seed " << seed;
  }
}

TEST(HandleFeasibilityTest, HandlesOnOnePointMeetHalfWay) {
  const std::vector<Handle> handles = {bare_handle("a", {0.05, 0.05}, 1),
                                       bare_handle("b", {0.05, 0.05}, 1)};
  Points3 targets(2, 3);
  targets << 0, 0, 0, 0.02, 0, 0;
  EXPECT_NEAR(HandleFeasibility(rectangle(0.1, 0.1), handles).project({0, 1}, targets), 0.01,
              HandleFeasibility::rounding);
  for (const int k : {0, 1})
    EXPECT_NEAR((targets.row(k) - Eigen::RowVector3d(0.01, 0, 0)).norm(), 0,
                HandleFeasibility::rounding);
}

TEST(HandleFeasibilityTest, HandlesOnOnePointWithOneTargetStayThere) {
  const std::vector<Handle> handles = {bare_handle("a", {0.05, 0.05}, 1),
                                       bare_handle("b", {0.05, 0.05}, 1),
                                       bare_handle("c", {0.1, 0.05}, 1)};
  Points3 targets(3, 3);
  targets << 1, 2, 3, 1, 2, 3, 1.04, 2, 3;
  const Points3 asked = targets;
  EXPECT_EQ(HandleFeasibility(rectangle(0.1, 0.1), handles).project({0, 1, 2}, targets), 0);
  EXPECT_TRUE(targets == asked);
  targets(2, 0) = 2;  // the two stay together when a third handle pulls at them
  EXPECT_GT(HandleFeasibility(rectangle(0.1, 0.1), handles).project({0, 1, 2}, targets), 0.1);
  EXPECT_LT((targets.row(0) - targets.row(1)).norm(), HandleFeasibility::rounding + settled);
}

TEST(HandleFeasibilityTest, ProjectionConsidersOnlyTheGivenHandles) {
  const std::vector<Handle> handles = {bare_handle("a", {0, 0}, 1), bare_handle("b", {0.01, 0}, 1),
                                       bare_handle("c", {0.1, 0}, 1)};
  Points3 targets(2, 3);
  targets << 0, 0, 0, 0.09, 0, 0;
  EXPECT_EQ(HandleFeasibility(rectangle(0.1, 0.1), handles).project({0, 2}, targets), 0);
  EXPECT_GT(HandleFeasibility(rectangle(0.1, 0.1), handles).project({0, 1}, targets), 0.03);
  Points3 nobody(0, 3);
  EXPECT_EQ(HandleFeasibility(rectangle(0.1, 0.1), handles).project({}, nobody), 0);
}

TEST(OvershootTest, OfAFrameIsTakenRoundTheSlotAndFromHandlesThatHoldHard) {
  const std::vector<Handle> handles = {bare_handle("left", left_tip, 1),
                                       bare_handle("right", right_tip, 1),
                                       bare_handle("middle", {0.05, 0}, 1)};
  std::vector<HandleFrame> frame(3);
  frame[0].state = frame[1].state = HandleFrame::held;
  frame[0].keyed = {0, 0, 0};
  frame[1].keyed = {0.15, 0, 0};  // farther than the tips are from each other in a straight line
  frame[2].keyed = {9, 9, 9};     // it holds nothing
  EXPECT_EQ(overshoot(u_shape, handles, frame, 0).of_handle, -1);
  const double over = 0.03;
  frame[1].keyed = {round_the_slot + over, 0, 0};
  const Overshoot found = overshoot(u_shape, handles, frame, 0);
  EXPECT_EQ(found.of_handle, 1);
  EXPECT_NEAR(found.length, over - HandleFeasibility::tolerance * round_the_slot, 2e-5);
  EXPECT_EQ(overshoot(u_shape, handles, frame, 1).of_handle, 0);
  frame[1].state = HandleFrame::soft;  // gives way
  EXPECT_EQ(overshoot(u_shape, handles, frame, 0).of_handle, -1);
}

}  // namespace
}  // namespace paperbake
