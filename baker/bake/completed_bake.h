#pragma once

#include "baker/bake/bake.h"

#include <filesystem>
#include <optional>
#include <string>

namespace paperbake {

// `.state/done`: what the last bake of a folder was asked for and how it ended, when it wrote all
// of it.

/// All that the files of a bake depend on: program, job, formats, names, frames with maps and
/// pictures.
std::string request_of(const BakeSettings&, const BakePlan&);

/// The outcome of the bake before, when that was asked for the same and every file is there as it
/// was written.
std::optional<BakeOutcome> finished_before(const std::filesystem::path& folder,
                                           const std::string& request);

/// throws Error(Fault::folder)
void note_finished(const std::filesystem::path& folder, const std::string& request,
                   const BakeOutcome&);

/// To be called before anything is written.
void forget_finished(const std::filesystem::path& folder);

}  // namespace paperbake
