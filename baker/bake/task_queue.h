#pragma once

#include <deque>
#include <functional>
#include <future>

namespace paperbake {

/// Where to start work that may run on a thread of its own.
std::launch launch_policy(int threads);

/// Does tasks one after the other, on threads of its own, while the bake goes on. With one thread
/// they are done on the spot.
class TaskQueue {
 public:
  explicit TaskQueue(int threads);

  /// Starts a task as soon as those before it are done; waits while too many are on the way. Frees
  /// the task when it is done. What the task throws, the future throws.
  std::shared_future<void> start(std::function<void()> task);
  /// Waits until all are done.
  void wait();

 private:
  std::launch policy_;
  std::deque<std::shared_future<void>> started_;  // the last ones
};

}  // namespace paperbake
