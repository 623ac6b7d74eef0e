#include "baker/bake/stop_request.h"

namespace paperbake {

using Clock = std::chrono::steady_clock;

bool StopRequest::is_made() {
  const std::lock_guard lock(mutex_);
  if (!since_ && asked_ && asked_()) since_ = Clock::now();
  return since_.has_value();
}

bool StopRequest::is_time_up() {
  return is_made() && Clock::now() - *since_ > std::chrono::milliseconds(500);  // set once
}

}  // namespace paperbake
