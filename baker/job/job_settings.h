#pragma once

#include "baker/job/settings.h"

#include <filesystem>
#include <string>

namespace paperbake {

bool is_job(const std::filesystem::path&);  // by its extension, .toml

/// Reads a job file into settings of which nothing is said yet; what the command line says comes
/// after it. Paths in it are meant from its folder. Names the output files after it. throws
/// Error(ErrorCode::command) as read_job does, and when it names no scene
void load_job(BakeSettings&, const std::filesystem::path& job);

/// The job file of these settings, to lie at `file`: every option with its meaning, those that were
/// said set, the others commented out, as are the sheets and handles of the scene. Baked, it gives
/// the same bytes.
std::string job_text(const BakeSettings&, const std::filesystem::path& file);

/// What the job file of these settings says of single sheets and handles, as job_text has it.
/// folder  that paths are relative to; empty: the working directory
std::string sections_text(const BakeSettings&, const std::filesystem::path& folder);

}  // namespace paperbake
