#include "baker/bake/map_recorder.h"

#include "core/geometry/curvature.h"
#include "formats/files/atomic_file.h"

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

void MapRecorder::draw_final() {
  if (!last_frame_) return;
  final_.bytes = std::make_shared<std::string>();
  final_.drawn = start(
      [exr = final_.bytes](const CreaseMap& map, const MapInfo& of) { *exr = map.file_bytes(of); });
  if (!bake_.caches.show_maps()) return;
  picture_.bytes = std::make_shared<std::string>();
  picture_.drawn = start([png = picture_.bytes](const CreaseMap& map, const MapInfo& of) {
    *png = png_bytes(map.picture(of));
  });
}

void MapRecorder::drop_final() { final_ = picture_ = {}; }

void MapRecorder::finish() {
  for (const File& file : files_)
    bake_.files.write(file.name, [&](const auto&) { file.written.get(); });
  files_.clear();
  if (final_.bytes)
    bake_.files.write(file_name("final"), [&](const auto& path) {
      final_.drawn.get();
      write_atomically(path, *final_.bytes);
    });
  if (!picture_.bytes) return;
  picture_.drawn.get();
  bake_.caches.add_map(bake_.plan.shots[sheet_].sheet_name + ": creases and singular points",
                       *picture_.bytes);
}

void MapRecorder::discard() {
  std::error_code none;
  for (const File& file : files_)
    if (*file.is_there) std::filesystem::remove(bake_.files.folder() / file.name, none);
  files_.clear();
  drop_final();
}

/// Calls draw(map_ as it is now, info()) while the bake goes on.
std::shared_future<void> MapRecorder::start(const Draw& draw) {
  return bake_.tasks.start(
      [clock = bake_.clock, draw, of = info(), map = std::make_shared<const CreaseMap>(map_)] {
        const StageClock::Part part(clock, Stage::maps);
        draw(*map, of);
      });
}

std::string MapRecorder::file_name(const std::string& frame) const {
  return fmt::format("maps/{}{}.{}.exr", bake_.plan.name, bake_.plan.sheets[sheet_].file_suffix,
                     frame);
}

void MapRecorder::write_map(const std::string& frame) {
  const std::string name = file_name(frame);
  const auto is_there = std::make_shared<bool>(false);
  const auto write = [path = bake_.files.folder() / name, is_there](const CreaseMap& map,
                                                                    const MapInfo& of) {
    map.write(path, of);
    *is_there = true;
  };
  files_.push_back({name, start(write), is_there});
}

MapInfo MapRecorder::info() const {
  return {*last_frame_, bake_.plan.animation.fps, bake_.plan.sheets[sheet_].seed,
          bake_.plan.sheets[sheet_].preset};
}

}  // namespace paperbake
