#pragma once

#include <chrono>

namespace paperbake {

/// Says when people have waited long enough for a sign of life: five seconds since it was made, or
/// since it said so last. And how long they have waited in all.
class FrequentMessage {
 public:
  bool is_due() {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    if (now - last_ < seconds(5)) return false;
    last_ = now;
    return true;
  }
  /// [s] from when it was made until it said so last
  long seconds_so_far() const {
    return std::chrono::duration_cast<std::chrono::seconds>(last_ - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

}  // namespace paperbake
