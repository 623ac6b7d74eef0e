#include "baker/bake/stage_clock.h"

#include <gtest/gtest.h>

#include <thread>

namespace paperbake {
namespace {

using Part = StageClock::Part;

/// Takes so much CPU time of this thread.
void work(double ms) {
  const double end = cpu_ms() + ms;
  while (cpu_ms() < end) continue;
}

TEST(StageClockTest, TimeOfAPartWithinAPartCountsOnce) {
  StageClock clock;
  {
    const Part outer(&clock, Stage::simulate);
    work(20);
    {
      const Part inner(&clock, Stage::maps);
      work(40);
    }
    work(20);
  }
  const auto seconds = clock.seconds();
  EXPECT_NEAR(seconds.at("simulate"), 0.04, 0.01);
  EXPECT_NEAR(seconds.at("maps"), 0.04, 0.01);
}

TEST(StageClockTest, PartsOfOtherThreadsAreAddedAndNothingIsLost) {
  StageClock clock;
  {
    const Part outer(&clock, Stage::render_frames);
    std::thread other([&clock] {
      const Part part(&clock, Stage::judge);
      work(50);
    });
    other.join();
    work(30);
  }
  work(20);
  const auto seconds = clock.seconds();
  EXPECT_NEAR(seconds.at("judge"), 0.05, 0.01);
  EXPECT_NEAR(seconds.at("render_frames"), 0.03, 0.01);
  EXPECT_GT(seconds.at("rest"), 0.015);
  double sum = 0;
  for (const auto& [name, value] : seconds)
    if (name != "all") sum += value;
  EXPECT_NEAR(sum, seconds.at("all"), 1e-9);
}

TEST(StageClockTest, WithoutAClockNothingIsAdded) {
  StageClock clock;
  {
    const Part outer(&clock, Stage::record);
    work(10);
    const Part nobody(nullptr, Stage::judge);
    work(30);
  }
  EXPECT_NEAR(clock.seconds().at("record"), 0.01, 0.005);
  EXPECT_EQ(clock.seconds().at("judge"), 0);
}

}  // namespace
}  // namespace paperbake
