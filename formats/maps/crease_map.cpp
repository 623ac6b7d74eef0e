#include "formats/maps/crease_map.h"

#include "core/model/error.h"
#include "formats/files/atomic_file.h"
#include "formats/maps/map_draw.h"

#include <cassert>

namespace paperbake {
namespace {

/// [1] creases whose ends are nearer to each other than this fraction of their width are the same
constexpr double same_crease = 0.5;

std::vector<std::vector<Vector2d>> loops_of(const Pattern& pattern) {
  std::vector<std::vector<Vector2d>> loops = pattern.holes;
  loops.push_back(pattern.outline);
  return loops;
}

}  // namespace

struct CreaseMap::State {
  Pattern pattern;
  CreaseMapOptions options;
  FoldPeak peak;
  MapScene scene;  // of the last recorded frame; write() and picture() set its frame and fps
};

CreaseMap::CreaseMap(const Pattern& pattern, const CreaseMapOptions& options) {
  assert(options.size >= 1);
  const double side = longer_side(pattern);
  state_ = std::make_unique<State>(State{
      pattern, options, FoldPeak(loops_of(pattern), {side, options.fold_width}, options.size), {}});
  MapScene& scene = state_->scene;
  scene.size = options.size;
  scene.side = side;
  scene.diagonal = extent(pattern).norm();
  scene.crease_width = options.crease_width;
  scene.fold_width = options.fold_width;
  scene.loops = loops_of(pattern);
  for (auto& loop : scene.loops)
    for (Vector2d& p : loop) p = to_texels(p, side, options.size);
  scene.peak = &state_->peak;
}

CreaseMap::CreaseMap(const CreaseMap& other) : state_(std::make_unique<State>(*other.state_)) {
  state_->scene.peak = &state_->peak;
}

CreaseMap::~CreaseMap() = default;

void CreaseMap::record(int frame, const Sheet& sheet, const Points3& curvature,
                       const Points3& plastic) {
  assert(curvature.rows() == sheet.pattern.rows());
  if (!curvature.allFinite() || !plastic.allFinite())
    throw Error(ErrorCode::simulation, "crease map",
                "The curvature of the sheet is not a finite number.");
  State& s = *state_;
  s.scene.fields = map_fields(sheet, curvature, plastic, s.options.fold_width);
  s.scene.apices = map_apices(sheet);
  s.peak.record(s.scene.fields);
  merge_creases(s.scene.creases, detect_creases(sheet, plastic, s.pattern, s.options.thresholds),
                frame, same_crease * s.options.crease_width);
}

std::string CreaseMap::file_bytes(const MapInfo& info) const {
  const CreaseMapOptions& options = state_->options;
  MapScene& scene = state_->scene;
  scene.frame = info.frame;
  scene.fps = info.fps;
  const MapScale scale{scene.side / scene.size, options.fold_width, options.crease_width};
  return encode_map(scene.size, options.layout, info, scale, options.threads,
                    [&](const MapRows& rows, MapTexel* texels) { draw_map(scene, rows, texels); });
}

void CreaseMap::write(const std::filesystem::path& path, const MapInfo& info) const {
  write_atomically(path, file_bytes(info));
}

Image CreaseMap::picture(const MapInfo& info) const {
  constexpr int max_size = 1024;
  constexpr Colour background{225, 225, 222}, paper{252, 250, 244}, outward{178, 48, 30},
      inward{36, 84, 168}, apex{20, 20, 20};
  MapScene& scene = state_->scene;
  scene.frame = info.frame;
  scene.fps = info.fps;
  const int every = (scene.size + max_size - 1) / max_size, size = scene.size / every;
  std::vector<MapTexel> strip(std::size_t(16) * scene.size);
  Image image{size, size, std::vector<Colour>(std::size_t(size) * size)};
  for (int first = 0; first < scene.size; first += 16) {
    const MapRows rows{scene.size, first, std::min(first + 16, scene.size)};
    std::fill(strip.begin(), strip.end(), MapTexel{});
    draw_map(scene, rows, strip.data());
    for (int row = first; row < rows.last; ++row)
      for (int i = 0; i / every < size && row / every < size && row % every == 0; i += every) {
        const MapTexel& t = strip[rows.index(i, row)];
        const Colour crease =
            mix(mix(background, paper, t.a), t.fold_peak >= 0 ? outward : inward, t.a * t.r);
        image.pixels[std::size_t(row / every) * size + i / every] = mix(crease, apex, t.a * t.g);
      }
  }
  return image;
}

}  // namespace paperbake
