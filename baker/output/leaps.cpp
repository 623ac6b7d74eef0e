#include "baker/output/leaps.h"

#include "core/model/pattern.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace paperbake {
namespace {

constexpr double least_leap = 0.02;    // [1] of the longer side
constexpr double sudden = 3;           // [1] times the motion in the frames beside it
constexpr double slow_drive = 1e-4;    // [m] within a frame: as good as none
constexpr double slow_motion = 0.001;  // [1] of the longer side within a frame: the same of a sheet

using Frames = std::vector<const FrameRecord*>;  // of one sheet

/// Those that a frame is compared with. In the first there is no motion to compare with.
Frames beside(const Frames& frames, std::size_t k) {
  Frames others;
  const auto add = [&](std::size_t other) {
    if (other > 0 && other < frames.size()) others.push_back(frames[other]);
  };
  if (frames[k]->statistics.inertia || k == 1)
    for (const std::size_t other : {k - 1, k + 1}) add(other);
  else
    for (const std::size_t other : {k - 1, k - 2}) add(other);
  return others;
}

/// Whether a handle lets go after the frame `before` and not after `now`: the sheet springs.
bool is_let_go(const Shot& shot, int before, int now) {
  return std::any_of(shot.handles.begin(), shot.handles.end(), [&](const Handle& handle) {
    return before < handle.release_frame && handle.release_frame <= now;
  });
}

void add_leaps(const Frames& frames, const Shot& shot, int first_frame, std::vector<Leap>& leaps) {
  const double side = longer_side(shot.pattern);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const FrameStatistics& now = frames[k]->statistics;
    if (now.moved <= std::max(least_leap * side, now.driven) || now.touching_others > 0 ||
        is_let_go(shot, frames[k - 1]->frame, frames[k]->frame))
      continue;
    double around = 0, drive = slow_drive;
    for (const FrameRecord* other : beside(frames, k)) {
      around = std::max(around, other->statistics.moved);
      drive = std::max(drive, other->statistics.driven);
    }
    if (now.moved >
        sudden * std::max(1.0, now.driven / drive) * std::max(around, slow_motion * side))
      leaps.push_back({frames[k]->frame, frames[k]->sheet, now.moved, around, now.singular > 0,
                       now.inertia,
                       frames[k - 1]->frame == first_frame && now.driven <= slow_drive});
  }
}

}  // namespace

std::vector<Leap> find_leaps(const std::vector<FrameRecord>& frames, const BakePlan& plan) {
  std::vector<Leap> leaps;
  for (const Shot& shot : plan.shots) {
    Frames of_sheet;
    for (const FrameRecord& f : frames)
      if (f.sheet == shot.sheet_name) of_sheet.push_back(&f);
    add_leaps(of_sheet, shot, plan.animation.first_frame, leaps);
  }
  std::stable_sort(leaps.begin(), leaps.end(),
                   [](const Leap& a, const Leap& b) { return a.frame < b.frame; });
  return leaps;
}

std::string describe(const std::vector<Leap>& all_leaps) {
  std::vector<Leap> leaps;
  std::copy_if(all_leaps.begin(), all_leaps.end(), std::back_inserter(leaps),
               [](const Leap& leap) { return !leap.crumpled; });
  if (leaps.empty()) return "";
  const Leap& longest = *std::max_element(
      leaps.begin(), leaps.end(), [](const Leap& a, const Leap& b) { return a.moved < b.moved; });
  std::string sentence = fmt::format(
      "in frame {} the sheet \"{}\" leaps by {:.1f} mm, where it moves by {:.1f} mm in the frames "
      "beside it and nothing drives it so fast",
      longest.frame, longest.sheet, 1e3 * longest.moved, 1e3 * longest.around);
  if (leaps.size() > 1) {
    std::vector<std::string> others;
    for (const Leap& leap : leaps)
      if (&leap != &longest) others.push_back(std::to_string(leap.frame));
    constexpr std::size_t most = 6;
    const bool all = others.size() <= most;
    others.resize(std::min(most, others.size()));
    sentence += fmt::format("; frame{} {}{} {} like it", leaps.size() == 2 ? "" : "s",
                            fmt::join(others, ", "), all ? "" : " and more",
                            leaps.size() == 2 ? "is" : "are");
  }
  if (longest.springs)
    return sentence +
           ". It does not rest in the shape in which it was modelled. Model it as it lies at rest, "
           "hold it with handles, or mark its folds as creases with paper_crease = \"modelled\".";
  // paper without inertia has no speed, and is in its other shape at once
  return sentence +
         fmt::format(". If it shows, try {}more --base-triangles, or slower keys.",
                     longest.inertia
                         ? ""
                         : "--dynamics on without --polish, with which a snap takes time, ");
}

}  // namespace paperbake
