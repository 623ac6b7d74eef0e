#include "baker/bake/frame_queue.h"

#include "core/model/plastic_grid.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace paperbake {
namespace {

class FrameQueueTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, FrameQueueTest, testing::Values(1, 2));

AnimatedFrame frame_of(int number, const Sheet& sheet) {
  AnimatedFrame frame;
  frame.frame = number;
  frame.sheet = &sheet;
  return frame;
}

TEST_P(FrameQueueTest, ConsumerSeesEveryFrameInOrderAsItWasWhenPushed) {
  std::vector<std::pair<int, double>> seen;
  FrameQueue queue(GetParam(), [&](const AnimatedFrame& frame) {
    seen.emplace_back(frame.frame, frame.sheet->x(0, 0));
  });
  Sheet sheet;
  sheet.x = Points3::Zero(1, 3);
  for (int f = 0; f < 100; ++f) {
    sheet.x(0, 0) = 0.5 * f;
    EXPECT_TRUE(queue.push(frame_of(f, sheet)));
    sheet.x(0, 0) = -1;  // the simulation goes on
  }
  queue.finish();
  ASSERT_EQ(seen.size(), 100u);
  for (int f = 0; f < 100; ++f) EXPECT_EQ(seen[f], std::make_pair(f, 0.5 * f));
}

TEST_P(FrameQueueTest, MemoryOfThePaperStaysWithTheSimulation) {
  const Sheet sheet;
  std::vector<bool> seen;
  FrameQueue queue(GetParam(), [&](const AnimatedFrame& frame) {
    seen.push_back(frame.plastic_grid != nullptr);
  });
  {
    const PlasticGrid memory(Pattern{{{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}}, {}});
    AnimatedFrame frame = frame_of(1, sheet);
    frame.plastic_grid = &memory;
    EXPECT_TRUE(queue.push(frame));
  }
  queue.finish();
  EXPECT_EQ(seen, std::vector<bool>{false});
}

TEST_P(FrameQueueTest, WhatTheConsumerThrowsStopsTheShotAndComesOut) {
  int consumed = 0;
  const auto run = [&] {
    FrameQueue queue(GetParam(), [&](const AnimatedFrame& frame) {
      if (frame.frame == 3) throw std::runtime_error("disk full");
      ++consumed;
    });
    const Sheet sheet;
    for (int f = 0; f < 1000; ++f)
      if (!queue.push(frame_of(f, sheet))) break;
    queue.finish();
  };
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_EQ(consumed, 3);
}

}  // namespace
}  // namespace paperbake
