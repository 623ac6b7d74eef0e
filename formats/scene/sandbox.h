#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// Limits of a sandboxed process; exceeding one of them ends it.
struct SandboxLimits {
  std::uint64_t bytes = 0;  // of memory, in addition to what this process uses
  unsigned seconds = 0;     // of CPU time
  // the only folders that it may read, with all below; empty: all of them
  std::vector<std::filesystem::path> readable = {};
};

struct SandboxResult {
  // what the work returned; nothing when it did not finish
  std::optional<std::string> bytes;
  // how it ended instead, as part of a sentence: "crashed (Segmentation fault)", "ran for more than
  // 10 s"
  std::string ended;
};

/// Runs `work` in a child process: when third-party code crashes, allocates without limit or loops
/// on an unchecked file, only that process ends. What the work prints is discarded; an exception
/// that leaves it counts as a failure.
/// It cannot write files, reach a network or start programs (confinement.h), and ends with this
/// process.
SandboxResult run_sandboxed(const std::function<std::string()>& work, const SandboxLimits&);

}  // namespace paperbake
