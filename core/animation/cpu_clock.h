#pragma once

#include <ctime>

namespace paperbake {

/// CPU time of this thread. [ms]
inline double cpu_ms() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * t.tv_sec + 1e-6 * t.tv_nsec;
}

}  // namespace paperbake
