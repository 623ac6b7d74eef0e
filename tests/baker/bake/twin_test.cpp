// A bake and its twin: whether a scene determines the shape of the paper.

#include "baker/bake/twin.h"

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::Ended;

Handle handle(const std::vector<double>& heights) {
  Handle h;
  h.keyed = Points3::Zero(static_cast<Eigen::Index>(heights.size()), 3);
  for (std::size_t row = 0; row < heights.size(); ++row)
    h.keyed(static_cast<Eigen::Index>(row), 2) = heights[row];
  return h;
}

TEST(Twin, HandlesAreMovedByAMicrometreWhereTheyMoveAndNowhereElse) {
  BakePlan plan;
  plan.shots.push_back({});
  plan.sheets.emplace_back().seed = 7;
  plan.shots[0].handles = {handle({0, 0, 0.01, 0.02, 0.02, 0.02}), handle({0, 0, 0, 0, 0, 0})};
  const BakePlan twin = twin_of(plan);
  const Points3 moved = twin.shots[0].handles[0].keyed - plan.shots[0].handles[0].keyed;
  EXPECT_EQ(moved.topRows(2).cwiseAbs().maxCoeff(), 0) << "it starts where it was";
  for (int row : {2, 3}) EXPECT_GT(moved.row(row).norm(), 1e-8);
  EXPECT_NE(moved.row(2), moved.row(3));
  EXPECT_LE(moved.cwiseAbs().maxCoeff(), 1.0001e-6);
  EXPECT_LT((moved.row(4) - moved.row(3)).norm(), 1e-15) << "a handle that rests stays at rest";
  EXPECT_LT((moved.row(5) - moved.row(3)).norm(), 1e-15);
  EXPECT_EQ(twin.shots[0].handles[1].keyed, plan.shots[0].handles[1].keyed);
}

/// A plan of one sheet of 100 mm whose start shape has five points.
BakePlan plan_with(const Handle& handle) {
  BakePlan plan;
  plan.shots.push_back({});
  plan.sheets.emplace_back().seed = 7;
  plan.animation.first_frame = 1;
  Shot& shot = plan.shots[0];
  shot.pattern.outline = {{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}};
  shot.start.x.resize(5, 3);
  shot.start.x << 0, 0, 0, 0.1, 0, 0, 0.1, 0.1, 0, 0, 0.1, 0, 0.05, 0.05, 0.01;
  shot.handles = {handle};
  return plan;
}

// What lands on something, or is pushed, meets it in another way; and is bent as it was.
TEST(Twin, ASheetThatNoHandleMovesIsMovedAndTiltedAsAWhole) {
  Handle resting = handle({0.1, 0.1, 0.1});
  resting.keyed(1, 2) += 1e-12;  // interpolated
  const BakePlan plan = plan_with(resting), twin = twin_of(plan);
  const Points3 &was = plan.shots[0].start.x, &is = twin.shots[0].start.x, moved = is - was;
  EXPECT_GT(moved.row(0).norm(), 1e-8);
  EXPECT_LE(moved.cwiseAbs().maxCoeff(), 4e-6);
  EXPECT_GT((moved.row(2) - moved.row(0)).norm(), 1e-8);
  for (int a = 0; a < 5; ++a)
    for (int b = 0; b < a; ++b)
      EXPECT_NEAR((is.row(a) - is.row(b)).norm(), (was.row(a) - was.row(b)).norm(), 1e-10);
  const Points3& held = twin.shots[0].handles[0].keyed;
  EXPECT_GT((held.row(0) - resting.keyed.row(0)).norm(), 1e-8);
  EXPECT_LT((held.row(2) - held.row(0)).norm(), 1e-11) << "it rests";
}

TEST(Twin, AHandThatLeavesAfterItLetsGoMovesNothing) {
  Handle leaves = handle({0, 0, 0, 0.01, 0.02});
  leaves.release_frame = 3;
  const BakePlan plan = plan_with(leaves);
  EXPECT_NE(twin_of(plan).shots[0].start.x, plan.shots[0].start.x);
  leaves.release_frame = 5;  // it takes the sheet along in the fourth frame
  const BakePlan carried = plan_with(leaves);
  EXPECT_EQ(twin_of(carried).shots[0].start.x, carried.shots[0].start.x);
}

TEST(Twin, TheDistanceIsThatOfEqualPointsWhateverTheMesh) {
  BakePlan plan;
  plan.shots.push_back({});
  plan.shots[0].pattern.outline = {{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}};
  const auto flat = [](bool other_diagonal, double lifted) {
    Sheet sheet;
    sheet.pattern = (Points2(4, 2) << 0, 0, 0.2, 0, 0.2, 0.1, 0, 0.1).finished();
    sheet.triangles = other_diagonal ? (Triangles(2, 3) << 0, 1, 3, 1, 2, 3).finished()
                                     : (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished();
    sheet.x = Points3::Zero(4, 3);
    sheet.x.leftCols<2>() = sheet.pattern;
    sheet.x.col(2).array() += lifted;
    return sheet;
  };
  const Sheet here = flat(false, 0), there = flat(true, 0.002);
  AnimatedFrame frame;
  frame.frame = 3;
  frame.sheet = &here;
  SampledShapes shapes(plan);
  shapes.add(frame);
  frame.sheet = &there;
  ASSERT_TRUE(shapes.distance(frame));
  EXPECT_NEAR(*shapes.distance(frame), 0.002 / 0.2, 1e-12);
  frame.frame = 4;
  EXPECT_FALSE(shapes.distance(frame));
}

TEST(Twin, TheVerdictNamesTheFirstFrameBeyondTheLimit) {
  std::vector<FrameRecord> frames(4);
  EXPECT_FALSE(twin_verdict(frames));
  for (int k = 0; k < 4; ++k) {
    frames[k].frame = 10 + k;
    frames[k].twin = 1e-5 * k;
  }
  EXPECT_EQ(describe(*twin_verdict(frames)),
            "twin: a micrometre moves the paper by at most 0.003 % of the side, in frame 13.");
  frames[2].twin = 0.02;
  frames[3].twin = 0.015;
  const TwinVerdict verdict = *twin_verdict(frames);
  EXPECT_EQ(verdict.chaotic_from, 12);
  EXPECT_EQ(verdict.frame_of_largest, 12);
  EXPECT_NE(describe(verdict).find("from frame 12 on the scene is chaotic"), std::string::npos);
}

using TwinBake = test::CommandLine;

TEST_F(TwinBake, TheCertificateSaysHowFarTheTwinIsAndNothingElseChanges) {
  const Ended ended = run(crumple("1-6", {"--twin", "--progress", "plain"}));
  ASSERT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  EXPECT_NE(ended.err.find("twin: a micrometre moves the paper"), std::string::npos) << ended.err;
  const auto summary =
      nlohmann::json::parse(test::read(fs::path(output()) / "cert/summary.json"))["twin"];
  EXPECT_EQ(summary["jitter_m"], 1e-6);
  EXPECT_TRUE(summary["chaotic_from"].is_null());
  const double largest = summary["largest_pct"];
  EXPECT_GT(largest, 1e-7);
  EXPECT_LT(largest, 0.1);
  double seen = 0;
  for (const std::string& line :
       test::lines_of(test::read(fs::path(output()) / "cert/frames.jsonl")))
    seen = std::max(seen, nlohmann::json::parse(line)["twin_pct"].get<double>());
  EXPECT_EQ(seen, largest);
  const std::string cache = test::read(fs::path(output()) / "S4_crumple.abc");
  EXPECT_EQ(run({"verify", output()}).code, 0);
  fs::remove_all(output());
  run(crumple("1-6", {"--progress", "none"}));
  EXPECT_EQ(test::read(fs::path(output()) / "S4_crumple.abc"), cache);
  EXPECT_TRUE(nlohmann::json::parse(test::read(fs::path(output()) / "cert/summary.json"))["twin"]
                  .is_null());
}

}  // namespace
}  // namespace paperbake
