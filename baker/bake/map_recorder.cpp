#include "baker/bake/map_recorder.h"

#include "core/geometry/curvature.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {
namespace {

CreaseMapOptions map_options(const BakeSettings& settings, const Shot& shot) {
  CreaseMapOptions options;
  options.size = settings.map_size;
  options.layout = settings.map_layout;
  options.threads = settings.threads;
  options.fold_width = ridge_width(shot.paper, shorter_side(shot.pattern));
  // the fibres of a sharp crease break over a few thicknesses
  options.crease_width = 6 * shot.paper.thickness;
  options.thresholds = crease_thresholds(shot.paper);
  return options;
}

}  // namespace

MapRecorder::MapRecorder(const BakeContext& bake, std::size_t sheet)
    : bake_(bake),
      sheet_(sheet),
      map_(bake.plan.shots[sheet].pattern, map_options(bake.settings, bake.plan.shots[sheet])) {}

void MapRecorder::consume(const AnimatedFrame& frame) {
  map_.record(frame.frame, *frame.sheet, vertex_curvature(*frame.sheet), frame.plastic_curvature);
  last_frame_ = frame.frame;
  const BakePlan& plan = bake_.plan;
  const bool wanted = std::any_of(plan.map_frames.begin(), plan.map_frames.end(),
                                  [&](const FrameSpan& s) { return s.contains(frame.frame); });
  if (wanted && frame.frame >= plan.frames.first) write_map(fmt::format("{:04}", frame.frame));
}

void MapRecorder::finish() {
  if (!last_frame_) return;
  write_map("final");
  if (bake_.caches.show_maps())
    bake_.caches.add_map(bake_.plan.shots[sheet_].sheet_name + ": creases and singular points",
                         png_bytes(map_.picture(info())));
}

void MapRecorder::write_map(const std::string& frame) {
  bake_.files.write(fmt::format("maps/{}{}.{}.exr", bake_.plan.name, bake_.suffixes[sheet_], frame),
                    [&](const auto& path) { map_.write(path, info()); });
}

MapInfo MapRecorder::info() const {
  return {*last_frame_, bake_.plan.animation.fps, bake_.plan.seeds[sheet_],
          bake_.plan.presets[sheet_]};
}

}  // namespace paperbake
