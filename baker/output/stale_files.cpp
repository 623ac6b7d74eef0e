#include "baker/output/stale_files.h"

#include "baker/output/file_hash.h"
#include "formats/files/atomic_file.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

/// What a bake has written.
struct Written {
  std::string shot;                          // as its files are called
  std::map<std::string, std::string> files;  // paths, relative to the folder, and keys
};

Written read_list(const fs::path& list) {
  Written written;
  std::istringstream stream(read_file(list).value_or(""));
  for (std::string key, value; stream >> key && std::getline(stream.ignore(), value);)
    if (key == "shot")
      written.shot = value;
    else
      written.files[value] = key;
  return written;
}

/// Removes a folder below the output folder in which nothing is left. A link to a folder stays: it
/// is somebody's.
void remove_if_empty(const fs::path& base, const fs::path& folder) {
  std::error_code none;
  const fs::path place = folder.lexically_normal();
  if (place.empty() || place == "." || place.is_absolute() || *place.begin() == "..") return;
  if (fs::symlink_status(base / place, none).type() == fs::file_type::directory)
    fs::remove(base / place, none);  // fails where something is left
}

}  // namespace

bool outputs_unmodified(const fs::path& folder) {
  const auto files = read_list(folder / ".state" / "written").files;
  const auto whole = [&](const auto& file) {
    std::error_code none;
    return fs::is_regular_file(folder / file.first, none) &&
           file_hash(folder / file.first) == file.second;
  };
  return !files.empty() && std::all_of(files.begin(), files.end(), whole);
}

std::vector<std::string> replace_outputs(const fs::path& folder, const std::string& shot,
                                         const std::vector<fs::path>& written, StaleFiles stale,
                                         const std::map<fs::path, std::string>& keys) {
  const fs::path base = fs::absolute(folder).lexically_normal(), list = base / ".state" / "written";
  std::map<std::string, std::string> files;
  for (const fs::path& path : written) {
    const auto known = keys.find(path);
    files[fs::absolute(path).lexically_normal().lexically_relative(base).generic_string()] =
        known == keys.end() ? file_hash(path) : known->second;
  }
  const Written before = read_list(list);
  const auto is_of_another_shot = [&](const fs::path& path) {
    return before.shot != shot && path.filename().string().rfind(before.shot + ".", 0) == 0;
  };
  // Debug pictures may lie elsewhere. The list may be somebody else's: outside the folder it counts
  // only for folders into which this bake has written, too.
  std::set<fs::path> own_folders;
  for (const auto& file : files) own_folders.insert(fs::path(file.first).parent_path());
  const auto is_foreign = [&](const fs::path& path) {
    const fs::path place = path.lexically_normal();
    const bool is_outside = place.is_absolute() || (!place.empty() && *place.begin() == "..");
    return is_outside && own_folders.count(place.parent_path()) == 0;
  };
  std::vector<std::string> removed;
  for (const auto& [path, key] : before.files) {
    std::error_code none;
    if (is_of_another_shot(path)) continue;
    if (files.count(path) || !fs::is_regular_file(base / path, none) ||
        file_hash(base / path) != key)
      continue;
    if (stale != StaleFiles::remove || is_foreign(path)) {
      files[path] = key;
      continue;
    }
    if (fs::remove(base / path, none)) removed.push_back(path);
    remove_if_empty(base, fs::path(path).parent_path());
  }
  std::string text = "shot " + shot + "\n";
  for (const auto& [path, key] : files) text += key + " " + path + "\n";
  write_atomically(list, text);
  return removed;
}

}  // namespace paperbake
