#include "baker/bake/task_queue.h"

#include <utility>

namespace paperbake {

std::launch launch_policy(int threads) {
  return threads > 1 ? std::launch::async : std::launch::deferred;
}

TaskQueue::TaskQueue(int threads) : policy_(launch_policy(threads)) {}

std::shared_future<void> TaskQueue::start(std::function<void()> task) {
  constexpr std::size_t max_waiting = 4;  // a map takes 3 MB until it is drawn
  for (; started_.size() >= max_waiting; started_.pop_front()) started_.front().wait();
  std::shared_future<void> before;
  if (!started_.empty()) before = started_.back();
  started_.push_back(std::async(policy_, [before = std::move(before), task = std::move(task),
                                          abandoned = abandoned_]() mutable {
                       if (before.valid()) before.wait();
                       before = {};
                       const std::function<void()> own = std::move(task);
                       if (!*abandoned) own();
                     }).share());
  return started_.back();
}

void TaskQueue::abandon() {
  *abandoned_ = true;
  for (const std::shared_future<void>& task : started_) task.wait();
}

}  // namespace paperbake
