#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

// `.state/cached`: of which bake the caches in a folder are, and how many frames they have.

/// To be called when the caches and the list of all files (stale_files.h) are written.
/// key     of the bake, and of the attempt that is baked
/// frames  of each sheet in its caches
/// throws  Error(ErrorCode::folder)
void record_cached_frames(const std::filesystem::path& folder, const std::string& key,
                          const std::vector<std::size_t>& frames);

/// Whether the files in the folder are as a bake of this key has left them, and their caches have
/// more frames of some sheet.
/// frames  of each sheet
bool are_longer_caches_there(const std::filesystem::path& folder, const std::string& key,
                             const std::vector<std::size_t>& frames);

}  // namespace paperbake
