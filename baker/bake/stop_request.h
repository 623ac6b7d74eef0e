#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>

namespace paperbake {

/// Whether somebody wants a bake to end, and how much time it has left to hand on what it has. All
/// that was simulated and rendered is kept for a later bake in any case.
class StopRequest {
 public:
  /// asked  has somebody asked for it? empty: nobody does
  explicit StopRequest(std::function<bool()> asked) : asked_(std::move(asked)) {}

  bool is_made();
  /// It was made half a second ago: files are completed with what is in them.
  bool is_time_up();

 private:
  std::mutex mutex_;
  std::function<bool()> asked_;
  std::optional<std::chrono::steady_clock::time_point> since_;  // when it was first seen
};

}  // namespace paperbake
