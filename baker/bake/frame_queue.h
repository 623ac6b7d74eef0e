#pragma once

#include "core/animation/animate.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace paperbake {

/// Hands frames to a consumer in order, on a thread of its own, so that writing one frame and
/// simulating the next go on at the same time. With one thread the consumer is called on the spot.
/// Either way it sees the same frames in the same order.
class FrameQueue {
 public:
  FrameQueue(int threads, std::function<void(const AnimatedFrame&)> consumer);
  ~FrameQueue();

  /// Copies the frame and its sheet, but not its plastic_grid and its state, which change with the
  /// next frame; waits while too many are on the way. returns false once the consumer has thrown.
  bool push(const AnimatedFrame&);

  /// Waits until all frames are consumed; throws what the consumer threw.
  void finish();

 private:
  struct Item {
    AnimatedFrame frame;
    Sheet sheet;
  };
  void consume();

  std::function<void(const AnimatedFrame&)> consumer_;
  std::deque<Item> items_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::exception_ptr failure_;
  bool closed_ = false;
  std::thread thread_;
};

}  // namespace paperbake
