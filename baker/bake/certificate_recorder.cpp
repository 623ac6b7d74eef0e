#include "baker/bake/certificate_recorder.h"

#include "baker/job/input_hash.h"
#include "baker/output/gates.h"
#include "core/geometry/collider_motion.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"
#include "core/hands/handle_feasibility.h"
#include "core/model/air.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace paperbake {
namespace {

constexpr int samples_along = 13;  // points by which the motion of a sheet is measured

/// [rad] To which a crease springs back, averaged over its length.
double mean_rest_angle(const Sheet& sheet, const PrescribedCrease& crease) {
  double sum = 0, length = 0;
  for (const CreaseEdge& edge : sheet.crease_edges)
    if (crease_under({crease}, edge.a, edge.b)) {
      sum += (edge.b - edge.a).norm() * edge.rest_angle;
      length += (edge.b - edge.a).norm();
    }
  return length > 0 ? sum / length : crease.angle;
}

}  // namespace

CertificateRecorder::CertificateRecorder(const BakeContext& bake, std::size_t sheet)
    : bake_(bake),
      sheet_(sheet),
      input_hash_(bake.plan.sheets[sheet].start_hash),
      samples_(bake.plan.shots[sheet].pattern, samples_along) {}

void CertificateRecorder::consume(const AnimatedFrame& frame) {
  const BakePlan& plan = bake_.plan;
  input_hash_ = frame_input_hash(input_hash_, plan, frame.frame);
  const std::vector<SingularPoint>& singular = frame.sheet->singular;
  for (std::size_t k = known_singular_; k < singular.size(); ++k)
    bake_.certificate.singular.push_back({plan.shots[sheet_].sheet_name, singular[k]});
  known_singular_ = singular.size();
  record_folds(*frame.sheet, frame.frame);
  if (!plan.frames.contains(frame.frame)) return;
  WrittenFrame now = look_at(frame);
  FrameRecord record = measure(frame, now);
  if (plan.shots[sheet_].colliders && !is_handed_on(frame.frame))
    judge_inside(*frame.sheet, record);
  FrameRecord& line = bake_.certificate.add_line(sheet_, std::move(record));
  count_intersections(*frame.sheet, line);
  record_handles(frame);
  before_ = std::move(now);
}

/// Of a sheet that stands still, everything is where it was.
CertificateRecorder::WrittenFrame CertificateRecorder::look_at(const AnimatedFrame& frame) const {
  const Sheet& sheet = *frame.sheet;
  const bool still = before_ && same_entries(sheet.x, before_->x);
  const bool same = still && same_entries(sheet.triangles, before_->triangles);
  Points3 samples = still ? before_->samples : samples_(sheet);
  const int crossing = same ? before_->crossings : crossings(sheet);
  return {frame.frame, sheet.x, std::move(samples), sheet.triangles, frame.handles, crossing};
}

FrameRecord CertificateRecorder::measure(const AnimatedFrame& frame,
                                         const WrittenFrame& now) const {
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
  statistics.crossings = now.crossings;
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const HandleFrame& handle = frame.handles[h];
    statistics.handle_error_max = std::max(statistics.handle_error_max, handle.error());
    if (handle.state == HandleFrame::jammed) r.jammed.push_back(jam_of(frame, h));
  }
  if (before_ && now.samples.rows() > 0) measure_motion(now, statistics);
  r.note = frame.note;
  note_what_was_not_solved(frame, r);
  r.input_hash = input_hash_;
  return r;
}

Jam CertificateRecorder::jam_of(const AnimatedFrame& frame, std::size_t handle) const {
  // [1] of its distance: a handle that is farther off than twice the overshoot has another reason
  constexpr double explained = 0.5;
  const Shot& shot = bake_.plan.shots[sheet_];
  const double off = frame.handles[handle].error();
  Jam jam{shot.handles[handle].name, 1e3 * off};
  if (is_out_of_reach(bake_.plan, shot.sheet_name, jam.handle, frame.frame)) return jam;
  const Overshoot over =
      overshoot(shot.pattern, shot.handles, frame.handles, static_cast<int>(handle));
  if (over.length > explained * off) jam.taut_to = shot.handles[over.of_handle].name;
  return jam;
}

void CertificateRecorder::measure_motion(const WrittenFrame& now,
                                         FrameStatistics& statistics) const {
  statistics.moved = rms_distance(now.samples, before_->samples);
  for (std::size_t h = 0; h < now.handles.size(); ++h) {
    const HandleFrame &handle = now.handles[h], &before = before_->handles[h];
    if (handle.state != HandleFrame::free && before.state != HandleFrame::free)
      statistics.driven = std::max(statistics.driven, (handle.keyed - before.keyed).norm());
  }
  double by_colliders = 0;
  if (const auto& colliders = bake_.plan.shots[sheet_].colliders)
    for (int frame = before_->frame + 1; frame <= now.frame; ++frame)
      by_colliders += farthest_move(*colliders, frame - bake_.plan.animation.first_frame);
  statistics.driven = std::max({statistics.driven, by_colliders, way_of_wind(now, statistics)});
}

double CertificateRecorder::way_of_wind(const WrittenFrame& now,
                                        const FrameStatistics& statistics) const {
  const AnimateOptions& options = bake_.plan.animation;
  const Air& air = options.elastic.air;
  if (!statistics.inertia || air.winds.empty()) return 0;
  const Vector3d middle = now.samples.colwise().mean();
  const auto speed = [&](int frame) {
    return air_velocity(air, (frame - options.first_frame) / options.fps, middle).norm();
  };
  double way = 0;
  for (int frame = before_->frame + 1; frame <= now.frame; ++frame)
    way += std::max(speed(frame - 1), speed(frame)) / options.fps;
  return way;
}

/// A stored energy is a sum of squares. And paper that moves, or whose handles move, does not stand
/// still to the last bit, unless its step was given up; or it is taut already, and they go on.
void CertificateRecorder::note_what_was_not_solved(const AnimatedFrame& frame,
                                                   FrameRecord& record) const {
  constexpr double least_motion = 1e-5;  // [m] of a handle within a frame
  if (frame.statistics.energy < 0)
    append_note(record.note,
                fmt::format("the stored energy is below zero, {:.3g} J: the step was not "
                            "solved",
                            frame.statistics.energy));
  if (!before_) return;
  const std::vector<HandleFrame>& before = before_->handles;
  bool moves = false;
  const Shot& shot = bake_.plan.shots[sheet_];
  const bool is_taut = std::any_of(record.jammed.begin(), record.jammed.end(),
                                   [](const Jam& jam) { return !jam.taut_to.empty(); });
  for (std::size_t h = 0; h < frame.handles.size(); ++h)
    moves |= frame.handles[h].state != HandleFrame::free && before[h].state != HandleFrame::free &&
             (frame.handles[h].keyed - before[h].keyed).norm() > least_motion && !is_taut &&
             !is_out_of_reach(bake_.plan, shot.sheet_name, shot.handles[h].name, frame.frame);
  // where the simulation itself says why the sheet stays behind, that is enough
  const bool silent = !frame.statistics.converged && frame.note.empty();
  record.step_unsolved = (moves || silent) && same_entries(frame.sheet->x, before_->x);
  if (record.step_unsolved)
    append_note(record.note, moves ? "the sheet stands still although its handles move: the step "
                                     "was not solved"
                                   : "the sheet stands still although it is not at rest: the step "
                                     "was not solved");
}

bool CertificateRecorder::is_handed_on(int frame) const {
  return !bake_.caches.empty() && bake_.caches.frames_shown().contains(frame);
}

void CertificateRecorder::judge_inside(const Sheet& sheet, FrameRecord& record) {
  const Shot& shot = bake_.plan.shots[sheet_];
  if (!colliders_) colliders_ = std::make_shared<const JudgedColliders>(*shot.colliders);
  const double side = longer_side(shot.pattern);
  const CacheJudge judge(sheet.pattern / side, sheet.triangles, side, colliders_);
  enter(judge(sheet.x, record.frame - bake_.plan.animation.first_frame), record);
}

void CertificateRecorder::count_intersections(const Sheet& sheet, FrameRecord& record) const {
  if (bake_.plan.shots.size() < 2) return;
  const int count = bake_.certificate.intersections.add(record.frame, sheet);
  record.statistics.crossings_with_others = count;
  if (count > 0) append_note(record.note, "passes through another sheet");
}

void CertificateRecorder::record_folds(const Sheet& sheet, int frame) const {
  std::vector<std::optional<int>>& first = bake_.certificate.frames_of_folding[sheet_];
  std::vector<CreaseLine>& found = bake_.certificate.found_creases[sheet_];
  const std::size_t announced = bake_.plan.shots[sheet_].pattern.prescribed_creases.size();
  const std::vector<bool> folded = which_are_folded(sheet);
  first.resize(std::max(first.size(), folded.size()));
  for (std::size_t k = 0; k < folded.size(); ++k)
    if (folded[k] && !first[k]) first[k] = frame;
  for (std::size_t k = announced; k < folded.size(); ++k) {
    const PrescribedCrease& crease = sheet.prescribed_creases[k];
    if (k - announced == found.size())
      found.push_back({crease.line, 0, false, "found while the sheet was folded"});
    found[k - announced].angle = mean_rest_angle(sheet, crease);
  }
}

void CertificateRecorder::record_handles(const AnimatedFrame& frame) const {
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
    r.state = handle.state;
    bake_.certificate.handles.push_back(std::move(r));
  }
}

}  // namespace paperbake
