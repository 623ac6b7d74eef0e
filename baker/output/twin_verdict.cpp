#include "baker/output/twin_verdict.h"

#include <fmt/format.h>

namespace paperbake {

std::optional<TwinVerdict> twin_verdict(const std::vector<FrameRecord>& frames) {
  std::optional<TwinVerdict> verdict;
  for (const FrameRecord& f : frames) {
    if (!f.twin) continue;
    if (!verdict) verdict.emplace().frame_of_largest = f.frame;
    if (*f.twin > verdict->largest) {
      verdict->largest = *f.twin;
      verdict->frame_of_largest = f.frame;
    }
    std::optional<int>& from = verdict->chaotic_from;
    if (*f.twin > twin_limit && (!from || f.frame < *from)) from = f.frame;
  }
  return verdict;
}

std::string describe(const TwinVerdict& verdict) {
  const std::string most = fmt::format("{:.2g} % of the side, in frame {}", 100 * verdict.largest,
                                       verdict.frame_of_largest);
  if (!verdict.chaotic_from)
    return fmt::format("twin: a micrometre moves the paper by at most {}.", most);
  return fmt::format(
      "twin: from frame {} on the scene is chaotic: a micrometre moves the paper by up to {}.",
      *verdict.chaotic_from, most);
}

}  // namespace paperbake
