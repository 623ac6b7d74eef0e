#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <memory>

namespace paperbake {

/// Where to start work that may run on a thread of its own.
std::launch launch_policy(int threads);

/// Does tasks one after the other, on threads of its own, while the bake goes on. With one thread
/// they are done when somebody waits for them.
class TaskQueue {
 public:
  explicit TaskQueue(int threads);

  /// Starts a task as soon as those before it are done; waits while too many are on the way. Frees
  /// the task when it is done. What the task throws, the future throws.
  std::shared_future<void> start(std::function<void()> task);
  /// Nobody needs them any more: those that have not begun are not done, and their futures are
  /// ready all the same. Waits for the one that has begun.
  void abandon();

 private:
  std::launch policy_;
  std::shared_ptr<std::atomic<bool>> abandoned_ = std::make_shared<std::atomic<bool>>(false);
  std::deque<std::shared_future<void>> started_;  // the last ones
};

}  // namespace paperbake
