#pragma once

#include <string>
#include <vector>

namespace paperbake {

/// The parts of file names that tell the sheets of a scene apart: ".NAME" of each sheet, in their
/// order. Dots, slashes, colons, spaces and control characters become `_`, and what is beyond 80
/// bytes is left out; names that are equal after that get `_2`, `_3`, ..., as in the caches. A
/// single sheet needs none: it is empty.
std::vector<std::string> sheet_file_suffixes(const std::vector<std::string>& sheet_names);

/// The beginning of all file names of a shot: its name without control characters, and short enough
/// for every file to have a name that the system accepts (255 bytes).
/// suffixes  of the sheets
std::string legal_shot_name(std::string name, const std::vector<std::string>& suffixes);

/// One sentence for each sheet whose files are not called as its name alone would have it, because
/// those of another sheet are.
std::vector<std::string> describe_shared_names(const std::vector<std::string>& sheet_names);

}  // namespace paperbake
