#pragma once

#include <chrono>

namespace paperbake {

/// Says when people have waited long enough for a sign of life: five seconds since it was made, or
/// since it said so last.
class FrequentMessage {
 public:
  bool is_due() {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    if (now - last_ < seconds(5)) return false;
    last_ = now;
    return true;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace paperbake
