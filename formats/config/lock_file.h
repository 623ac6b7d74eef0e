#pragma once

#include "core/model/paper.h"

#include <filesystem>
#include <map>
#include <string>

namespace paperbake {

/// The settings in job.lock.toml with which a shot was simulated.
struct LockedJob {
  std::string method;
  double fps = 24;                      // [1/s]
  double gravity = 0;                   // [m/s2]
  double stop = 1e-5;                   // [m] Newton's stopping tolerance
  std::map<std::string, Paper> papers;  // by name of the sheet
};

/// Reads job.lock.toml. throws Error(ErrorCode::command) with file, line and column of a syntax
/// error, or with the key that is missing
LockedJob read_lock(const std::filesystem::path&);

}  // namespace paperbake
