#include "baker/bake/sheet_recorder.h"

#include "baker/output/debug_pictures.h"
#include "core/geometry/crease_network.h"
#include "core/geometry/measure.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

SheetRecorder::SheetRecorder(const BakeContext& bake, std::size_t sheet)
    : bake_(bake),
      sheet_(sheet),
      certificate_(bake, sheet),
      renders_(!bake.caches.empty() && bake.settings.mesh == CacheMesh::render) {
  const Shot& shot = bake.plan.shots[sheet];
  if (renders_ && bake.caches.store_crease_attributes())
    attributes_.emplace(shot, ridge_width(shot.paper, shorter_side(shot.pattern)),
                        bake.plan.animation.fps);
  if (renders_ && bake.plan.guides) guides_.emplace(shot);
  if (!bake.caches.empty() && !renders_) simulation_cache_.emplace(bake, sheet);
  if (bake.settings.formats.count("maps")) maps_.emplace(bake, sheet);
}

void SheetRecorder::consume(const AnimatedFrame& frame) {
  const StageClock::Part part(bake_.clock, Stage::record);
  if (renders_) record_.add(frame);
  if (attributes_) attributes_->add(frame);
  if (guides_) guides_->add(frame);
  certificate_.consume(frame);
  if (simulation_cache_) simulation_cache_->consume(frame);
  last_ = *frame.sheet;
  if (maps_) {
    const StageClock::Part of_maps(bake_.clock, Stage::maps);
    maps_->consume(frame);
  }
  draw_debug_picture(frame);
  if (bake_.plan.frames.contains(frame.frame))
    bake_.progress.simulated(bake_.certificate.line(sheet_, frame.frame));
}

void SheetRecorder::finish_simulation() {
  if (simulation_cache_) simulation_cache_->finish();
  bake_.certificate.crease_length += crease_network(last_).length;
}

void SheetRecorder::draw_final_map() {
  const StageClock::Part part(bake_.clock, Stage::maps);
  if (maps_) maps_->draw_final();
}

void SheetRecorder::drop_final_map() {
  if (maps_) maps_->drop_final();
}

void SheetRecorder::finish() {
  const StageClock::Part part(bake_.clock, Stage::maps);
  if (maps_) maps_->finish();
}

void SheetRecorder::discard() {
  if (maps_) maps_->discard();
}

std::vector<CacheLayer> SheetRecorder::crease_attributes(std::size_t k, const Points2& pattern) {
  if (!attributes_) return {};
  return attributes_->at(k, record_, pattern);
}

std::optional<CacheGuides> SheetRecorder::guides(int frame, const CacheFrame& mesh) {
  if (!guides_) return {};
  return guides_->at(frame, mesh);
}

CacheProxy SheetRecorder::simulated(std::size_t k) const {
  const Sheet sheet = record_.sheet(record_.frames().at(k));
  return {sheet.x, sheet.triangles};
}

void SheetRecorder::draw_debug_picture(const AnimatedFrame& frame) {
  const BakePlan& plan = bake_.plan;
  if (!bake_.settings.debug_pictures || frame.frame < plan.frames.first) return;
  const bool listed = std::any_of(plan.debug_frames.begin(), plan.debug_frames.end(),
                                  [&](const FrameSpan& s) { return s.contains(frame.frame); });
  if (!listed && frame.statistics.new_singular == 0 && frame.frame != plan.frames.last) return;
  const Shot& shot = plan.shots[sheet_];
  const std::string title =
      fmt::format("{}, {}, {}, frame {}", plan.name, shot.sheet_name, plan.method, frame.frame);
  const auto file =
      *bake_.settings.debug_pictures /
      fmt::format("{}{}.{:04}.png", plan.name, plan.sheets[sheet_].file_suffix, frame.frame);
  if (bake_.files.failures.try_write(file.string(),
                                     [&] { write_png(file, debug_picture(shot, frame, title)); }))
    bake_.files.add_picture(file);
}

}  // namespace paperbake
