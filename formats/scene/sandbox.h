#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace paperbake {

/// What a process of its own may take; beyond them it ends.
struct SandboxLimits {
  std::uint64_t bytes = std::uint64_t(2) << 30;  // of memory, besides what this process has already
  unsigned seconds = 10;                         // of CPU time
};

struct SandboxResult {
  // what the work returned, whole; none: it did not come to its end
  std::optional<std::string> bytes;
  // else how it ended, for a sentence: "crashed (Segmentation fault)", "ran for more than 10 s"
  std::string ended;
};

/// Does the work in a process of its own: whatever foreign code makes of bytes that nobody has
/// checked - a crash, memory without end, a loop - is the end of that process only. The work must
/// return; what it prints is lost, what it throws is a crash.
SandboxResult run_sandboxed(const std::function<std::string()>& work, const SandboxLimits& = {});

}  // namespace paperbake
