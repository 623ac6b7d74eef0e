#include "baker/output/bake_files.h"

#include "core/model/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

bool BakeFiles::write(const std::string& file,
                      const std::function<void(const std::filesystem::path&)>& write) {
  if (!failures.try_write(file, [&] { write(folder_ / file); })) return false;
  add(file);
  return true;
}

std::vector<std::size_t> BakeFiles::finish_cache(
    const std::string& file, const std::vector<std::size_t>& wanted,
    const std::function<std::vector<std::size_t>()>& finish,
    const std::function<int(std::size_t n)>& frame_number) {
  try {
    const std::vector<std::size_t> kept = finish();
    const std::size_t most = kept.empty() ? 0 : *std::max_element(kept.begin(), kept.end());
    if (kept != wanted) {
      const Error no_room(ErrorCode::folder, (folder_ / file).string(),
                          "There was no room for all of it.", "Make room, and bake again.");
      failures.record_partial(
          file, most > 0 ? fmt::format("ends at frame {}", frame_number(most - 1)) : "has no frame",
          no_room);
    }
    if (most > 0) add(file);
    return kept;
  } catch (const Error& error) {
    failures.try_write(file, [&] { throw error; });
  }
  return std::vector<std::size_t>(wanted.size(), 0);
}

void BakeFiles::move_to_front_after(std::size_t count) {
  std::rotate(written_.begin(), written_.begin() + static_cast<std::ptrdiff_t>(count),
              written_.end());
}

}  // namespace paperbake
