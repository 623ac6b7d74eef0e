// A bake that is killed fifty times, at any moment of it, ends with the bytes of one that never
// was.

#include "tests/baker/bake/resume_fixture.h"

#include <random>

namespace paperbake {
namespace {

using test::Words;
using KillPushTest = test::ResumePushFixture;

class KillTest : public test::ResumeFixture, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, KillTest, testing::Values("hybrid", "fem", "adaptive"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(KillTest, ABakeThatIsKilledFiftyTimesEndsLikeOneThatNeverWas) {
  Words how{"--method", GetParam(), "--checkpoint", "5"};
  if (std::string(GetParam()) != "hybrid") how.insert(how.end(), {"--triangles", "300"});
  bake_whole("whole", how, "1-80");
  std::mt19937 random(1);
  int killed = 0;
  for (int attempt = 0; killed < 50 && attempt < 200; ++attempt) {
    // every tenth time it is begun anew: late frames are not the only ones to be killed at
    if (attempt % 10 == 0) std::filesystem::remove_all(folder / "out");
    killed += bake_until(static_cast<int>(random() % 12), static_cast<int>(random() % 100000),
                         SIGKILL, words("out", how, "1-80")) == -1;
  }
  EXPECT_EQ(killed, 50);
  bake_whole("out", how, "1-80");
  expect_same("out", "whole");
}

/// Where a fold is found that nobody announced, which looks at the steps before and the keys to
/// come, and a box presses it.
TEST_F(KillPushTest, ABakeWithCollidersThatIsKilledThirtyTimesEndsLikeOneThatNeverWas) {
  const auto pinched = [&](const std::string& out) {
    return Words{"bake",         test::samples + "/F6_pinch.glb",
                 "-o",           folder / out,
                 "--frames",     "1-70",
                 "--map-size",   "32",
                 "--quality",    "draft",
                 "--progress",   "plain",
                 "--checkpoint", "6"};
  };
  run(pinched("whole"));
  std::mt19937 random(1);
  int killed = 0;
  for (int attempt = 0; killed < 30 && attempt < 200; ++attempt) {
    if (attempt % 5 == 0) std::filesystem::remove_all(folder / "out");
    killed += bake_until(static_cast<int>(random() % 20), static_cast<int>(random() % 200000),
                         SIGKILL, pinched("out")) == -1;
  }
  EXPECT_EQ(killed, 30);
  run(pinched("out"));
  expect_same("out", "whole");
}

TEST_F(KillPushTest, ABakeOfTwoSheetsThatIsKilledThirtyTimesEndsLikeOneThatNeverWas) {
  run(pushed("whole", 2, 0.03, over));
  std::mt19937 random(1);
  int killed = 0;
  for (int attempt = 0; killed < 30 && attempt < 200; ++attempt) {
    if (attempt % 5 == 0) std::filesystem::remove_all(folder / "out");
    killed += bake_until(static_cast<int>(random() % 20), static_cast<int>(random() % 50000),
                         SIGKILL, pushed("out", 2, 0.03, over)) == -1;
  }
  EXPECT_EQ(killed, 30);
  run(pushed("out", 2, 0.03, over));
  expect_same("out", "whole");
}

}  // namespace
}  // namespace paperbake
