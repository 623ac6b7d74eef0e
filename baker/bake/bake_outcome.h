#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

struct BakeOutcome {
  int exit_code = 0;  // 0, or 4 (gate_missed): baked, but a gate was missed
  // what was written, in the order in which an artist looks for it
  std::vector<std::filesystem::path> files;
  std::vector<std::string> missed;  // a sentence for each gate that was missed
};

}  // namespace paperbake
