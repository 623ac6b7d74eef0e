#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace paperbake {

enum class StaleFiles { remove, keep };

/// Makes an output folder that of the bake that wrote these files: what the bake before it wrote
/// and this one did not is removed, unless somebody has changed it since; files of others stay.
/// Which they were, `.state/written` says: a key and a path a line.
/// kept  for a bake that could not write all it should: the older files stay for now, and on the
///       list
/// keys  of written files, as far as they are known: path and file_hash()
/// throws Error(ErrorCode::folder)
void replace_outputs(const std::filesystem::path& folder,
                     const std::vector<std::filesystem::path>& written, StaleFiles,
                     const std::map<std::filesystem::path, std::string>& keys = {});

/// Every file on that list is there as it was written, and there are some.
bool outputs_unmodified(const std::filesystem::path& folder);

}  // namespace paperbake
