#include "baker/bake/sheet_recorder.h"

#include "baker/output/cache_measure.h"
#include "baker/output/debug_pictures.h"
#include "core/geometry/crease_network.h"
#include "core/geometry/curvature.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {
namespace {

/// Across what rolled paper turns: no ridge of this sheet is wider. [m]
double widest_fold(const Shot& shot) { return ridge_width(shot.paper, shorter_side(shot.pattern)); }

CreaseMapOptions map_options(const BakeSettings& settings, const Shot& shot) {
  CreaseMapOptions options;
  options.size = settings.map_size;
  options.layout = settings.map_layout;
  options.threads = settings.threads;
  options.fold_width = widest_fold(shot);
  // the fibres of a sharp crease break over a few thicknesses
  options.crease_width = 6 * shot.paper.thickness;
  options.thresholds.yield_curvature = 2 * shot.paper.yield_strain / shot.paper.thickness;
  return options;
}

void append_note(FrameRecord& record, const std::string& note) {
  record.note += (record.note.empty() ? "" : "; ") + note;
}

/// Notes that the sheet is inside a collider, where that can be seen.
void note_inside(FrameRecord& record) {
  constexpr double visible = 0.1;  // [mm]
  const double inside_mm = 1e3 * record.statistics.inside_colliders;
  if (inside_mm > visible)
    append_note(record, fmt::format("inside a collider by {:.2f} mm", inside_mm));
}

}  // namespace

SheetRecorder::SheetRecorder(const BakeSettings& settings, const BakePlan& plan, std::size_t sheet,
                             CacheWriters& caches, std::string suffix, Certificate& certificate,
                             BakeFiles& files, Progress& progress)
    : settings_(settings),
      plan_(plan),
      sheet_(sheet),
      shot_(plan.shots[sheet]),
      caches_(caches),
      suffix_(std::move(suffix)),
      certificate_(certificate),
      files_(files),
      progress_(progress),
      input_hash_(plan.start_hash[sheet]) {
  if (caches_.wants_layers()) damage_.emplace(shot_, widest_fold(shot_), plan.animation.fps);
}

void SheetRecorder::consume(const AnimatedFrame& frame) {
  const bool wanted = plan_.frames.contains(frame.frame),
             simulated = settings_.mesh == CacheMesh::simulation;
  input_hash_ =
      frame_input_hash(input_hash_, plan_.shots, frame.frame, plan_.animation.first_frame);
  if (caches_.any() && !simulated) {
    record_.add(frame);
    if (damage_) damage_->add(frame);
  }
  for (std::size_t k = known_singular_; k < frame.sheet->singular.size(); ++k)
    certificate_.singular.push_back({shot_.sheet_name, frame.sheet->singular[k]});
  known_singular_ = frame.sheet->singular.size();
  if (wanted) {
    certificate_.frames.push_back(measure(frame));
    count_intersections(*frame.sheet, certificate_.frames.back());
    record_handles(frame);
  }
  flush_deferred(&*frame.sheet);
  before_ = std::move(now_);
  now_ = *frame.sheet;
  if (wanted && caches_.any() && simulated) defer(*frame.sheet);
  draw_map(frame);
  draw_debug_picture(frame);
  if (wanted) progress_.simulated(certificate_.frames.back());
}

std::optional<RenderInput> SheetRecorder::render_input() {
  flush_deferred(nullptr);
  certificate_.crease_length += crease_network(now_).length;
  if (record_.frames().empty()) return {};
  RenderInput shown{&record_,
                    &shot_,
                    {},
                    [this](int number, const CacheFrame& frame, const RenderStatistics& numbers) {
                      while (certificate_.frames[rendered_].frame != number ||
                             certificate_.frames[rendered_].sheet != shot_.sheet_name)
                        ++rendered_;
                      FrameRecord& r = certificate_.frames[rendered_];
                      r.statistics.render = numbers;
                      r.content_hash = caches_.add_frame(sheet_, number, frame);
                      progress_.rendered(r);
                    }};
  if (damage_)
    shown.layers = [this](std::size_t k, const Points2& pattern) {
      return damage_->at(k, record_, pattern);
    };
  return shown;
}

void SheetRecorder::finish() {
  if (!map_) return;
  write_map("final");
  if (caches_.report())
    caches_.report()->add_map(shot_.sheet_name + ": creases and singular points",
                              png_bytes(map_->picture(map_info())));
}

FrameRecord SheetRecorder::measure(const AnimatedFrame& frame) const {
  const Sheet& sheet = *frame.sheet;
  const LengthDistortion length = length_distortion(sheet);
  FrameRecord r;
  r.frame = frame.frame;
  r.sheet = shot_.sheet_name;
  r.statistics = frame.statistics;
  FrameStatistics& statistics = r.statistics;
  statistics.triangles = static_cast<int>(sheet.triangles.rows());
  statistics.stretch_mean = length.mean;
  statistics.stretch_max = length.largest;
  statistics.angle_defect_max = angle_defect_max(sheet);
  statistics.singular = static_cast<int>(sheet.singular.size());
  statistics.crossings = crossings(sheet);
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const HandleFrame& handle = frame.handles[h];
    if (handle.state == HandleFrame::free) continue;
    const double off = (handle.at - handle.keyed).norm();
    statistics.handle_error_max = std::max(statistics.handle_error_max, off);
    if (handle.state == HandleFrame::jammed) r.jammed.push_back({shot_.handles[h].name, 1e3 * off});
  }
  r.note = frame.note;
  note_inside(r);
  r.input_hash = input_hash_;
  return r;
}

void SheetRecorder::count_intersections(const Sheet& sheet, FrameRecord& record) {
  if (plan_.shots.size() < 2) return;
  record.statistics.crossings_with_others = certificate_.intersections.add(record.frame, sheet);
  if (record.statistics.crossings_with_others > 0)
    append_note(record, "passes through another sheet");
}

void SheetRecorder::record_handles(const AnimatedFrame& frame) {
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const HandleFrame& handle = frame.handles[h];
    HandleRecord r;
    r.frame = frame.frame;
    r.sheet = shot_.sheet_name;
    r.handle = shot_.handles[h].name;
    r.pattern = shot_.handles[h].pattern;
    r.keyed = handle.keyed;
    r.held = handle.at;
    r.state = handle.state == HandleFrame::held   ? HandleRecord::held_state
              : handle.state == HandleFrame::free ? HandleRecord::free_state
                                                  : HandleRecord::jammed_state;
    certificate_.handles.push_back(std::move(r));
  }
}

void SheetRecorder::draw_map(const AnimatedFrame& frame) {
  if (!settings_.formats.count("maps")) return;
  if (!map_) map_.emplace(shot_.pattern, map_options(settings_, shot_));
  map_->record(frame.frame, *frame.sheet, vertex_curvature(*frame.sheet), frame.plastic_curvature);
  last_map_frame_ = frame.frame;
  const bool wanted = std::any_of(plan_.map_frames.begin(), plan_.map_frames.end(),
                                  [&](const FrameSpan& s) { return s.contains(frame.frame); });
  if (wanted && frame.frame >= plan_.frames.first) write_map(fmt::format("{:04}", frame.frame));
}

void SheetRecorder::write_map(const std::string& frame) {
  const std::string file = fmt::format("maps/{}{}.{}.exr", plan_.name, suffix_, frame);
  if (files_.failures.try_write(file, [&] { map_->write(files_.folder / file, map_info()); }))
    files_.written.push_back(files_.folder / file);
}

void SheetRecorder::draw_debug_picture(const AnimatedFrame& frame) {
  if (!settings_.debug_pictures || frame.frame < plan_.frames.first) return;
  const bool listed = std::any_of(plan_.debug_frames.begin(), plan_.debug_frames.end(),
                                  [&](const FrameSpan& s) { return s.contains(frame.frame); });
  if (!listed && frame.statistics.new_singular == 0 && frame.frame != plan_.frames.last) return;
  const std::string title =
      fmt::format("{}, {}, {}, frame {}", plan_.name, shot_.sheet_name, plan_.method, frame.frame);
  const auto file =
      *settings_.debug_pictures / fmt::format("{}{}.{:04}.png", plan_.name, suffix_, frame.frame);
  if (files_.failures.try_write(file.string(),
                                [&] { write_png(file, debug_picture(shot_, frame, title)); }))
    files_.pictures.push_back(file);
}

MapInfo SheetRecorder::map_info() const {
  return {last_map_frame_, plan_.animation.fps, plan_.seeds[sheet_], plan_.presets[sheet_]};
}

void SheetRecorder::defer(const Sheet& sheet) {
  CacheFrame frame;
  frame.x = sheet.x;
  frame.normal = vertex_normals(sheet.x, sheet.triangles);
  frame.triangles = sheet.triangles;
  frame.uv = sheet.pattern / longer_side(shot_.pattern);
  frame.velocity = sheet.v;  // backward difference, where neighbours cannot be compared
  deferred_ = std::move(frame);
  deferred_record_ = certificate_.frames.size() - 1;
}

/// Central difference of the true motion of the sheet points that are vertices of the waiting
/// frame, `now_`. next: the sheet one frame later; null at the end of the shot.
void SheetRecorder::flush_deferred(const Sheet* next) {
  if (!deferred_) return;
  const double fps = plan_.animation.fps;
  const bool has_before = before_.x.rows() > 0;
  if (has_before && next)
    deferred_->velocity = 0.5 * fps * (resample(*next) - resample(before_));
  else if (next)
    deferred_->velocity = fps * (resample(*next) - now_.x);
  else if (has_before)
    deferred_->velocity = fps * (now_.x - resample(before_));
  FrameRecord& r = certificate_.frames[deferred_record_];
  const LengthDistortion stored = cache_distortion(*deferred_, longer_side(shot_.pattern));
  RenderStatistics& render = r.statistics.render.emplace();
  render.triangles = static_cast<int>(deferred_->triangles.rows());
  render.stretch_mean = stored.mean;
  render.stretch_max = stored.largest;
  render.crossings = r.statistics.crossings;
  render.crossings_with_others = r.statistics.crossings_with_others;
  r.content_hash = caches_.add_frame(sheet_, r.frame, *deferred_);
  deferred_.reset();
}

/// Where the vertices of now_ are in another frame, whatever its mesh. |V|x3 [m]
Points3 SheetRecorder::resample(const Sheet& other) const {
  const bool same = other.pattern.rows() == now_.pattern.rows() && other.pattern == now_.pattern;
  return same ? other.x : MeshTransfer(other.pattern, other.triangles, now_.pattern)(other.x);
}

}  // namespace paperbake
