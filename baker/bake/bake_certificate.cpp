#include "baker/bake/bake_certificate.h"

#include <algorithm>
#include <string>

namespace paperbake {

BakeCertificate::BakeCertificate(const BakePlan& plan)
    : found_creases(plan.shots.size()), plan_(plan) {
  for (const Shot& shot : plan.shots)
    frames_of_folding.emplace_back(shot.pattern.prescribed_creases.size());
}

FrameRecord& BakeCertificate::add_line(std::size_t sheet, FrameRecord record) {
  line_of_[{sheet, record.frame}] = frames_.size();
  return frames_.emplace_back(std::move(record));
}

FrameRecord& BakeCertificate::line(std::size_t sheet, int frame) {
  return frames_[line_of_.at({sheet, frame})];
}

std::vector<std::size_t> BakeCertificate::lines_of_sheets() const {
  std::vector<std::size_t> lines(plan_.shots.size(), 0);
  for (const auto& [sheet_and_frame, line] : line_of_) ++lines[sheet_and_frame.first];
  return lines;
}

void BakeCertificate::finalize(const std::vector<std::size_t>& in_cache) {
  std::vector<std::size_t> seen(in_cache.size(), 0);
  for (const auto& [sheet_and_frame, line] : line_of_)  // frame by frame of each sheet
    if (const std::size_t sheet = sheet_and_frame.first; seen[sheet]++ >= in_cache[sheet])
      frames_[line].content_hash.clear();
  line_of_.clear();

  const auto by_frame = [](const auto& a, const auto& b) { return a.frame < b.frame; };
  std::stable_sort(frames_.begin(), frames_.end(), by_frame);
  std::stable_sort(handles.begin(), handles.end(), by_frame);
  std::map<std::string, std::size_t> number;
  for (std::size_t s = 0; s < plan_.shots.size(); ++s) number[plan_.shots[s].sheet_name] = s;
  std::stable_sort(singular.begin(), singular.end(),
                   [&](const auto& a, const auto& b) { return number[a.sheet] < number[b.sheet]; });
}

}  // namespace paperbake
