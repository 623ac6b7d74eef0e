#include "baker/bake/cached_frames.h"

#include "baker/output/stale_files.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

namespace paperbake {
namespace {

namespace fs = std::filesystem;

fs::path path_of_cached(const fs::path& folder) { return folder / ".state" / "cached"; }

}  // namespace

void record_cached_frames(const fs::path& folder, const std::string& key,
                          const std::vector<std::size_t>& frames) {
  write_atomically(path_of_cached(folder), json_lines({{"key", key}, {"frames", frames}}));
}

bool are_longer_caches_there(const fs::path& folder, const std::string& key,
                             const std::vector<std::size_t>& frames) {
  try {
    const Json record = parse_json(read_file(path_of_cached(folder)).value_or(""));
    const auto there = record.at("frames").get<std::vector<std::size_t>>();
    if (record.at("key") != key || there.size() != frames.size()) return false;
    bool longer = false;
    for (std::size_t s = 0; s < frames.size(); ++s) longer |= there[s] > frames[s];
    return longer && outputs_unmodified(folder);
  } catch (const std::exception&) {
    return false;  // there is none, or it is somebody else's
  }
}

}  // namespace paperbake
