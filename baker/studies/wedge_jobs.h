#pragma once

#include "baker/studies/wedge.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// Bakes all variations, `max_running` at a time, each by a process of its own that this program
/// starts with --index, and tells of each on stderr; at the end also of folders that an earlier
/// wedge has left.
/// arguments  of the command line that asked for the wedge
/// returns  as finish_wedge does
/// stop       as that of a bake
/// throws Error(ErrorCode::stopped): it was stopped, and so were the bakes
WedgeOutcome bake_wedge(const Wedge&, int max_running, const std::vector<std::string>& arguments,
                        const std::function<bool()>& stop);

/// Leaves that to Slurm: writes DIR/wedge.sbatch and hands it to sbatch.
/// options  further ones of sbatch
/// throws   Error(ErrorCode::command): there is no sbatch here, or it refuses; the script stays
void submit_wedge(const Wedge&, const std::vector<std::string>& arguments,
                  const std::string& options);

}  // namespace paperbake
