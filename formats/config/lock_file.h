#pragma once

#include "core/model/paper.h"

#include <filesystem>
#include <map>
#include <string>

namespace paperbake {

/// What job.lock.toml says of how a shot was simulated.
struct LockedJob {
  std::string method;
  double fps = 24;                      // [1/s]
  double gravity = 0;                   // [m/s2]
  double stop = 1e-5;                   // [m]
  std::map<std::string, Paper> papers;  // by sheet
};

/// throws Error(Fault::command) that names file, line and column, or the key that is not there
LockedJob read_lock(const std::filesystem::path&);

}  // namespace paperbake
