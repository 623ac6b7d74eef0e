#pragma once

#include "baker/bake/bake_outcome.h"
#include "baker/job/plan.h"

#include <filesystem>
#include <optional>
#include <string>

namespace paperbake {

// `.state/done`: what the last bake of a folder was asked for and how it ended, when it wrote all
// of it.

/// All that the files of a bake depend on: program, job, formats, names, frames with maps and
/// pictures.
std::string bake_key(const BakeSettings&, const BakePlan&);

/// The outcome of the bake before, when that was asked for the same and every file is there as it
/// was written.
std::optional<BakeOutcome> find_completed_bake(const std::filesystem::path& folder,
                                               const std::string& key);

/// throws Error(ErrorCode::folder)
void record_completed_bake(const std::filesystem::path& folder, const std::string& key,
                           const BakeOutcome&);

/// To be called before anything is written.
void invalidate_completed_bake(const std::filesystem::path& folder);

}  // namespace paperbake
