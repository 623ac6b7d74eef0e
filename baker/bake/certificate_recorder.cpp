#include "baker/bake/certificate_recorder.h"

#include "core/geometry/curvature.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
namespace {

void append_note(FrameRecord& record, const std::string& note) {
  record.note += (record.note.empty() ? "" : "; ") + note;
}

/// Notes that the sheet is inside a collider, where that is visible.
void note_inside(FrameRecord& record) {
  constexpr double visible = 0.1;  // [mm]
  const double inside_mm = 1e3 * record.statistics.inside_colliders;
  if (inside_mm > visible)
    append_note(record, fmt::format("inside a collider by {:.2f} mm", inside_mm));
}

HandleRecord::State record_state(HandleFrame::State state) {
  switch (state) {
    case HandleFrame::held:
      return HandleRecord::held_state;
    case HandleFrame::free:
      return HandleRecord::free_state;
    case HandleFrame::jammed:
      return HandleRecord::jammed_state;
  }
  return HandleRecord::free_state;
}

}  // namespace

void CertificateRecorder::consume(const AnimatedFrame& frame) {
  const BakePlan& plan = bake_.plan;
  input_hash_ = frame_input_hash(input_hash_, plan.shots, frame.frame, plan.animation.first_frame);
  const std::vector<SingularPoint>& singular = frame.sheet->singular;
  for (std::size_t k = known_singular_; k < singular.size(); ++k)
    bake_.certificate.singular.push_back({plan.shots[sheet_].sheet_name, singular[k]});
  known_singular_ = singular.size();
  record_folds(*frame.sheet, frame.frame);
  if (!plan.frames.contains(frame.frame)) return;
  FrameRecord& line = bake_.certificate.add_line(sheet_, measure(frame));
  count_intersections(*frame.sheet, line);
  record_handles(frame);
}

FrameRecord CertificateRecorder::measure(const AnimatedFrame& frame) const {
  const Sheet& sheet = *frame.sheet;
  const Shot& shot = bake_.plan.shots[sheet_];
  const LengthDistortion length = length_distortion(sheet);
  FrameRecord r;
  r.frame = frame.frame;
  r.sheet = shot.sheet_name;
  r.statistics = frame.statistics;
  FrameStatistics& statistics = r.statistics;
  statistics.triangles = static_cast<int>(sheet.triangles.rows());
  statistics.stretch_mean = length.mean;
  statistics.stretch_max = length.largest;
  statistics.angle_defect_max = angle_defect_max(sheet);
  statistics.singular = static_cast<int>(sheet.singular.size());
  const std::vector<bool> folded = which_are_folded(sheet);
  statistics.folds = static_cast<int>(std::count(folded.begin(), folded.end(), true));
  statistics.crossings = crossings(sheet);
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const HandleFrame& handle = frame.handles[h];
    if (handle.state == HandleFrame::free) continue;
    const double off = (handle.at - handle.keyed).norm();
    statistics.handle_error_max = std::max(statistics.handle_error_max, off);
    if (handle.state == HandleFrame::jammed) r.jammed.push_back({shot.handles[h].name, 1e3 * off});
  }
  r.note = frame.note;
  note_inside(r);
  r.input_hash = input_hash_;
  return r;
}

void CertificateRecorder::count_intersections(const Sheet& sheet, FrameRecord& record) {
  if (bake_.plan.shots.size() < 2) return;
  const int count = bake_.certificate.intersections.add(record.frame, sheet);
  record.statistics.crossings_with_others = count;
  if (count > 0) append_note(record, "passes through another sheet");
}

void CertificateRecorder::record_folds(const Sheet& sheet, int frame) {
  std::vector<std::optional<int>>& first = bake_.certificate.frames_of_folding[sheet_];
  const std::vector<bool> folded = which_are_folded(sheet);
  for (std::size_t k = 0; k < folded.size(); ++k)
    if (folded[k] && !first[k]) first[k] = frame;
}

void CertificateRecorder::record_handles(const AnimatedFrame& frame) {
  const Shot& shot = bake_.plan.shots[sheet_];
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const HandleFrame& handle = frame.handles[h];
    HandleRecord r;
    r.frame = frame.frame;
    r.sheet = shot.sheet_name;
    r.handle = shot.handles[h].name;
    r.pattern = shot.handles[h].pattern;
    r.keyed = handle.keyed;
    r.held = handle.at;
    r.state = record_state(handle.state);
    bake_.certificate.handles.push_back(std::move(r));
  }
}

}  // namespace paperbake
