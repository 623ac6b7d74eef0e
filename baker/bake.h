#pragma once

#include "baker/plan.h"
#include "baker/progress.h"

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

struct BakeOutcome {
  int exit_code = 0;                            // 0, or 4: baked, but a gate was missed
  std::vector<std::filesystem::path> files;     // what was written, in the order an artist looks for it
  std::vector<std::string> missed;              // a sentence for each gate that was missed
};

/// Simulates the plan and writes its output folder: NAME.abc, maps/, cert/, singular.csv, job.lock.toml.
/// throws Error(Fault::folder): folder busy or not writable. Error(Fault::simulation): a sheet could not follow its handles;
/// the frames before are written all the same.
BakeOutcome bake(const BakeSettings&, const BakePlan&, Progress&);

}  // namespace paperbake
