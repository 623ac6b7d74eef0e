#include "baker/bake/frame_queue.h"

namespace paperbake {

FrameQueue::FrameQueue(int threads, std::function<void(const AnimatedFrame&)> consumer)
    : consumer_(std::move(consumer)) {
  if (threads > 1) thread_ = std::thread([this] { consume(); });
}

FrameQueue::~FrameQueue() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool FrameQueue::push(const AnimatedFrame& frame) {
  constexpr std::size_t max_waiting = 8;  // a few megabytes
  if (!thread_.joinable()) {
    AnimatedFrame alone = frame;
    alone.plastic_grid = nullptr;
    alone.state = nullptr;
    consumer_(alone);
    return true;
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return items_.size() < max_waiting || failure_; });
  if (failure_) return false;
  items_.push_back({frame, *frame.sheet});
  items_.back().frame.plastic_grid = nullptr;  // it flows on meanwhile
  items_.back().frame.state = nullptr;
  changed_.notify_all();
  return true;
}

void FrameQueue::finish() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

void FrameQueue::consume() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !items_.empty() || closed_; });
    if (items_.empty()) return;
    Item item = std::move(items_.front());
    items_.pop_front();
    lock.unlock();
    changed_.notify_all();
    item.frame.sheet = &item.sheet;
    try {
      consumer_(item.frame);
    } catch (...) {
      const std::lock_guard failed(mutex_);
      failure_ = std::current_exception();
      items_.clear();
      changed_.notify_all();
      return;
    }
  }
}

}  // namespace paperbake
