#include "baker/output/frames_that.h"

#include <fmt/format.h>
#include <set>

namespace paperbake {

std::string frames_that(const std::vector<FrameRecord>& frames,
                        const std::function<bool(const FrameRecord&)>& is_so) {
  std::set<int> found;  // the same frame has a record for each sheet
  for (const FrameRecord& f : frames)
    if (is_so(f)) found.insert(f.frame);
  if (found.empty()) return "";
  if (found.size() == 1) return fmt::format("frame {}", *found.begin());
  return fmt::format("{} frames from {} to {}", found.size(), *found.begin(), *found.rbegin());
}

}  // namespace paperbake
