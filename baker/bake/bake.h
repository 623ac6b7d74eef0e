#pragma once

#include "baker/job/plan.h"
#include "baker/output/progress.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {

struct BakeOutcome {
  int exit_code = 0;  // 0, or 4: baked, but a gate was missed
  // what was written, in the order an artist looks for it
  std::vector<std::filesystem::path> files;
  std::vector<std::string> missed;  // a sentence for each gate that was missed
};

/// Render pass or not, as the settings ask for.
Passes passes_of(const BakeSettings&);

/// Simulates the plan and writes its output folder: NAME.abc, maps/, cert/, singular.csv,
/// job.lock.toml. Files of the bake before it, unless somebody changed them, go with it. Frames
/// that a bake before it simulated with the same input are taken from its checkpoints, and where it
/// has already written all that is asked for nothing is done: the outcome is the same.
/// stop   asked after every frame: should this be the last one?
/// throws Error(Fault::folder): folder busy or not writable, or something could not be written;
/// Error(Fault::simulation): a sheet could not follow its handles; Error(Fault::stopped). What was
/// simulated until then is written all the same, as far as it can be.
BakeOutcome bake(const BakeSettings&, const BakePlan&, Progress&,
                 const std::function<bool()>& stop = {});

/// Warnings of a plan.
void print_warnings(const BakePlan&, Progress&);

/// The same, told on stderr: warnings, how far it is, gates that were missed.
BakeOutcome bake_with_progress(const BakeSettings&, const BakePlan&,
                               const std::function<bool()>& stop = {});

}  // namespace paperbake
