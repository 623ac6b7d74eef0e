#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace paperbake {

enum class StaleFiles { remove, keep };

/// Makes an output folder that of the bake that wrote these files: what the bake before it wrote
/// and this one did not is removed, unless somebody has changed it since, or it is called after
/// another shot; files of others stay. Which they were, `.state/written` says: the name of the
/// shot, and a key and a path a line. Folders that this empties go, too. Returns what was removed,
/// relative to the folder.
/// shot   what the files of this bake are called
/// stale  keep: for a bake that could not write all it should, the older files stay for now, and on
///        the list
/// keys  of written files, as far as they are known: path and file_hash()
/// throws Error(ErrorCode::folder)
std::vector<std::string> replace_outputs(
    const std::filesystem::path& folder, const std::string& shot,
    const std::vector<std::filesystem::path>& written, StaleFiles stale,
    const std::map<std::filesystem::path, std::string>& keys = {});

/// Every file on that list is there as it was written, and there are some.
bool outputs_unmodified(const std::filesystem::path& folder);

}  // namespace paperbake
