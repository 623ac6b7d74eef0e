#pragma once

#include <string>
#include <vector>

namespace paperbake {

/// The parts of file names that tell the sheets of a scene apart: ".NAME" of each sheet, in their
/// order. Dots, slashes, colons, spaces and control characters become `_`; names that are equal
/// after that get `_2`, `_3`, ..., as in the caches. A single sheet needs none: it is empty.
std::vector<std::string> sheet_file_suffixes(const std::vector<std::string>& sheet_names);

/// One sentence for each sheet whose files are not called as its name alone would have it, because
/// those of another sheet are.
std::vector<std::string> describe_shared_names(const std::vector<std::string>& sheet_names);

}  // namespace paperbake
