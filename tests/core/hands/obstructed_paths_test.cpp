#include "core/hands/obstructed_paths.h"

#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace paperbake {
namespace {

using Eigen::Isometry3d;
using test::bare_handle;
using test::rectangle;

constexpr double degrees = M_PI / 180;
const Pattern a4 = rectangle(0.210, 0.297);

Isometry3d turned(double angle, double y) {
  return Isometry3d(Eigen::Translation3d(0, y, 0) * Eigen::AngleAxisd(angle, Vector3d::UnitX()) *
                    Eigen::Translation3d(0, -y, 0));
}

/// Adds handles that hold a part of the sheet in one pose, for one frame.
void hold(std::vector<Handle>& handles, const std::string& name,
          const std::vector<Vector2d>& points, const Isometry3d& pose) {
  for (const Vector2d& p : points) {
    Handle handle = bare_handle(name + "." + std::to_string(handles.size()), p, 1);
    handle.keyed.row(0) = pose * Vector3d(p.x(), p.y(), 0);
    handles.push_back(std::move(handle));
  }
}

/// A letter folded in three at 99 and 198 mm, its bottom third held up to `free` [m] from its edge.
std::vector<Handle> letter(double free, double bottom = 172 * degrees, double top = 165 * degrees) {
  std::vector<Handle> handles;
  hold(handles, "middle", {{0, 0.110}, {0.210, 0.110}, {0.105, 0.147}, {0, 0.184}, {0.210, 0.184}},
       Isometry3d::Identity());
  hold(handles, "bottom",
       {{0, free}, {0.105, free}, {0.210, free}, {0.0525, 0.066}, {0.1575, 0.066}},
       turned(-bottom, 0.099));
  hold(handles, "top",
       {{0, 0.297}, {0.105, 0.297}, {0.210, 0.297}, {0.0525, 0.2475}, {0.1575, 0.2475}},
       turned(top, 0.198));
  return handles;
}

TEST(ObstructedPathsTest, TheTopOfALetterIsTooShortToGoRoundTheEdgeOfTheBottom) {
  const std::vector<UnreachablePair> pairs = obstructed_paths(a4, letter(0), 7, 7);
  ASSERT_EQ(pairs.size(), 1u);
  // from the top's own lower end over the edge to the end of the middle, in the plane across
  const Vector2d edge(0.099 - 0.099 * std::cos(172 * degrees), 0.099 * std::sin(172 * degrees)),
      end_of_top(0.198 + 0.0495 * std::cos(165 * degrees), 0.0495 * std::sin(165 * degrees)),
      end_of_middle(0.184, 0);
  const double way = (end_of_top - edge).norm() + (edge - end_of_middle).norm();
  EXPECT_NEAR(pairs[0].apart, way, 1e-9);
  EXPECT_NEAR(pairs[0].allowed, 0.2475 - 0.184, 1e-12);
  EXPECT_GT(way - pairs[0].allowed, 2e-3);
  EXPECT_EQ(pairs[0].frame, 7);
  EXPECT_EQ(pairs[0].around.rfind("bottom.", 0), 0u) << pairs[0].around;
  const bool top_first = pairs[0].a.rfind("top.", 0) == 0;
  EXPECT_EQ((top_first ? pairs[0].b : pairs[0].a).rfind("middle.", 0), 0u);
  EXPECT_NEAR((top_first ? pairs[0].from : pairs[0].to).y(), 0.2475, 1e-12);
  EXPECT_NEAR((top_first ? pairs[0].to : pairs[0].from).y(), 0.184, 1e-12);
  EXPECT_EQ(HandleFeasibility(a4, letter(0)).impossible_pairs(letter(0), 7, 7).size(), 0u)
      << "along the pattern there is paper enough";
}

TEST(ObstructedPathsTest, AFreeEdgeCanGetOutOfTheWay) {
  EXPECT_TRUE(obstructed_paths(a4, letter(0.030), 1, 1).empty());
}

TEST(ObstructedPathsTest, ALetterThatIsOnlyHalfFoldedHasAFreePath) {
  EXPECT_TRUE(obstructed_paths(a4, letter(0, 172 * degrees, 80 * degrees), 1, 1).empty());
}

TEST(ObstructedPathsTest, AnOuterLayerThatStaysOutsideIsFree) {
  EXPECT_TRUE(obstructed_paths(a4, letter(0, 172 * degrees, -165 * degrees), 1, 1).empty());
}

TEST(ObstructedPathsTest, ThePartOnlyCountsWhileAllOfItsHandlesHoldIt) {
  const auto pairs_with = [](const auto& change) {
    std::vector<Handle> handles = letter(0);
    for (Handle& handle : handles)
      if (handle.name.rfind("bottom", 0) == 0) change(handle);
    return obstructed_paths(a4, handles, 1, 3);
  };
  const std::vector<UnreachablePair> until_2 = pairs_with([](Handle& h) { h.release_frame = 3; });
  ASSERT_EQ(until_2.size(), 1u);
  EXPECT_EQ(until_2[0].first, 1);
  EXPECT_EQ(until_2[0].last, 2);
  EXPECT_TRUE(pairs_with([](Handle& h) { h.release_frame = 1; }).empty());
  EXPECT_TRUE(pairs_with([](Handle& h) { h.mode = HandleMode::relative; }).empty());
  EXPECT_TRUE(pairs_with([](Handle& h) { h.stiffness = 100; }).empty());
}

TEST(ObstructedPathsTest, PaperMayPassThroughAHole) {
  Pattern holed = a4;
  ASSERT_EQ(obstructed_paths(holed, letter(0), 1, 1).size(), 1u);
  holed.holes = {{{0.1, 0.03}, {0.1, 0.04}, {0.11, 0.04}, {0.11, 0.03}}};  // in the bottom
  EXPECT_TRUE(obstructed_paths(holed, letter(0), 1, 1).empty());
}

TEST(ObstructedPathsTest, ThePathRoundIsTheShortestOneOverAnySide) {
  // a square that is held flat, in any pose, between two points of the border far from it
  const Pattern sheet = rectangle(1, 1);
  const Vector2d from(0.7, 0), to(0.7, 0.02);
  const std::vector<Vector2d> corners{{0.1, 0.4}, {0.5, 0.4}, {0.6, 0.7}, {0.1, 0.8}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto vector = [&] { return Vector3d(any(random), any(random), any(random)); };
  int blocked = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Isometry3d pose = Eigen::Translation3d(vector()) *
                            Eigen::AngleAxisd(M_PI * any(random), vector().normalized());
    std::vector<Handle> handles;
    hold(handles, "flat", corners, pose);
    hold(handles, "point", {from, to}, Isometry3d::Identity());
    const Vector3d middle = pose * Vector3d(0.3, 0.6, 0), a = middle + 0.2 * vector(),
                   b = 2 * middle - a + 0.2 * vector();
    handles[4].keyed.row(0) = a;
    handles[5].keyed.row(0) = b;
    double least = std::numeric_limits<double>::infinity();
    constexpr int samples = 4000;
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k <= samples; ++k) {
        const Vector2d t = corners[i] + double(k) / samples * (corners[(i + 1) % 4] - corners[i]);
        const Vector3d over = pose * Vector3d(t.x(), t.y(), 0);
        least = std::min(least, (a - over).norm() + (over - b).norm());
      }
    for (const UnreachablePair& pair : obstructed_paths(sheet, handles, 1, 1)) {
      ++blocked;
      EXPECT_NEAR(pair.apart, least, 1e-6) << trial;
      EXPECT_GT(pair.apart, (a - b).norm()) << trial;
    }
  }
  EXPECT_GT(blocked, 50);
}

TEST(ObstructedPathsTest, PaperThatEndsInThePartIsNotInItsWay) {
  // the two points lie on both sides of the square on the pattern: the paper goes through it
  const Pattern sheet = rectangle(1, 1);
  std::vector<Handle> handles;
  hold(handles, "flat", {{0.4, 0.4}, {0.6, 0.4}, {0.6, 0.6}, {0.4, 0.6}}, Isometry3d::Identity());
  hold(handles, "point", {{0.5, 0.35}, {0.5, 0.65}}, Isometry3d::Identity());
  handles[4].keyed.row(0) << 0.5, 0.45, 0.2;
  handles[5].keyed.row(0) << 0.5, 0.5, -0.2;
  EXPECT_TRUE(obstructed_paths(sheet, handles, 1, 1).empty());
}

TEST(ObstructedPathsTest, TheyFollowThePairsThatAreTooFarApart) {
  std::vector<Handle> handles = letter(0);
  handles[0].keyed(0, 0) -= 0.01;  // one of the middle
  const std::vector<UnreachablePair> all = all_impossible_pairs(a4, handles, 1, 1);
  ASSERT_GT(all.size(), 1u);
  EXPECT_TRUE(all.front().around.empty());
  EXPECT_FALSE(all.back().around.empty());
}

}  // namespace
}  // namespace paperbake
