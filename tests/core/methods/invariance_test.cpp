#include "tests/bench/invariance.h"
#include "core/methods/hybrid.h"
#include "tests/bench/against_fem.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace paperbake::bench {
namespace {

Change change_named(const std::string& name) {
  for (const Change& change : changes())
    if (change.name == name) return change;
  throw std::invalid_argument(name);
}

/// A sample scene simulated with the hybrid method, under a change.
Shapes hybrid_shapes(const char* scene, const char* change, int last_frame) {
  const auto [shot, fps] = shot_of(cases_named({scene}).front());
  const auto make = [](const Shot& s, double turn) {
    return hybrid(s.pattern, s.paper, {120, turn}, {}, 0, 0);
  };
  return shapes_of(shot, make, change_named(change), 0, fps, last_frame);
}

TEST(InvarianceTest, AnArchIsTheSameWithOtherStepsSpeedsAndMeshes) {
  const Pattern pattern = shot_of(cases_named({"S1"}).front()).shot.pattern;
  const Shapes arch = hybrid_shapes("S1", "as it is", 24);
  ASSERT_EQ(arch.frames.size(), 6u);
  ASSERT_GT(arch.frames.back().col(2).maxCoeff(), 0.015);
  for (const char* change : {"dt x4", "dt /4", "speed x4", "mesh 17 deg"}) {
    const double apart = apart_pct(arch, hybrid_shapes("S1", change, 24), pattern);
    EXPECT_GT(apart, 1e-6) << change;  // the change did have an effect
    EXPECT_LT(apart, 0.2) << change;   // measured: 0.04-0.09
  }
}

TEST(InvarianceTest, AStripBucklesToTheSameSideOnEveryMesh) {
  const Pattern pattern = shot_of(cases_named({"S2"}).front()).shot.pattern;
  const Shapes strip = hybrid_shapes("S2", "as it is", 8);
  // the opposite side is 5 % away in frame 4
  for (const char* change : {"mesh 17 deg", "mesh 41 deg", "dt /4"})
    EXPECT_LT(apart_pct(strip, hybrid_shapes("S2", change, 8), pattern), 0.3) << change;
}

TEST(InvarianceTest, StepsOfFourFramesMeetHandlesWhereTheyWereKeyed) {
  Shot shot;
  Handle handle;
  handle.keyed.resize(9, 3);
  for (int f = 0; f < 9; ++f) handle.keyed.row(f) << f + 1, 0, 0;  // frame 1 is at 1 m
  handle.grab_frame = 6;
  shot.handles.push_back(handle);
  const Handle coarse = paced(shot, 4).handles.front(), fine = paced(shot, 0.25).handles.front();
  EXPECT_EQ(coarse.keyed(0, 0), 1);  // the first step begins where the scene does
  EXPECT_EQ(coarse.keyed(1, 0), 4);
  EXPECT_EQ(coarse.keyed(2, 0), 8);
  EXPECT_EQ(coarse.grab_frame, 2);
  EXPECT_EQ(fine.keyed(0, 0), 1);
  EXPECT_EQ(fine.keyed(2, 0), 1.5);
  EXPECT_EQ(fine.grab_frame, 24);
  EXPECT_FALSE(coarse.held(1));
  EXPECT_TRUE(fine.held(1000000));
}

}  // namespace
}  // namespace paperbake::bench
