#include "baker/bake/task_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

namespace paperbake {
namespace {

class TaskQueueTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, TaskQueueTest, testing::Values(1, 2));

TEST_P(TaskQueueTest, TasksAreDoneOneAfterTheOtherAndFreed) {
  TaskQueue queue(GetParam());
  std::vector<int> done;
  const auto held = std::make_shared<int>(0);
  std::vector<std::shared_future<void>> futures;
  for (int k = 0; k < 50; ++k)
    futures.push_back(queue.start([&done, held, k] { done.push_back(k); }));
  for (auto& future : futures) future.get();
  for (int k = 0; k < 50; ++k) EXPECT_EQ(done.at(k), k);
  EXPECT_EQ(held.use_count(), 1);
}

TEST_P(TaskQueueTest, WhatATaskThrowsItsFutureThrowsAndTheOthersAreDone) {
  TaskQueue queue(GetParam());
  bool done = false;
  auto thrown = queue.start([] { throw std::runtime_error("full"); });
  queue.start([&] { done = true; }).get();
  EXPECT_THROW(thrown.get(), std::runtime_error);
  EXPECT_TRUE(done);
}

TEST_P(TaskQueueTest, AbandonedTasksAreNotDone) {
  std::atomic<bool> may_end = false;
  std::atomic<int> begun = 0;
  {
    TaskQueue queue(GetParam());
    std::vector<std::shared_future<void>> futures;
    for (int k = 0; k < 3; ++k)
      futures.push_back(queue.start([&] {
        ++begun;
        while (!may_end) std::this_thread::yield();
      }));
    if (GetParam() > 1)
      while (begun == 0) std::this_thread::yield();
    std::thread later([&] { may_end = true; });
    queue.abandon();
    later.join();
    for (auto& future : futures)
      EXPECT_EQ(future.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  }
  if (GetParam() == 1) {
    EXPECT_EQ(begun, 0);
  }
}

TEST(TaskQueueTest, WithSeveralThreadsTheCallerGoesOnMeanwhile) {
  TaskQueue queue(2);
  std::atomic<bool> caller_went_on = false;
  bool has_waited = false;
  const auto task = queue.start([&] {
    while (!caller_went_on) std::this_thread::yield();
    has_waited = true;
  });
  EXPECT_NE(task.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  caller_went_on = true;
  task.get();
  EXPECT_TRUE(has_waited);
}

}  // namespace
}  // namespace paperbake
