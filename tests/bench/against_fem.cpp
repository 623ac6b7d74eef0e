#include "tests/bench/against_fem.h"

#include "core/geometry/collider_facing.h"
#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/methods/fem.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace paperbake::bench {
namespace {

constexpr int grid = 41;

}  // namespace

CaseShot shot_of(const Case& c) {
  Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + c.scene + ".glb");
  const SceneSheet& s = scene.sheets.front();
  Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  if (c.ground == Ground::kept)
    shot.colliders = facing_colliders(std::move(scene.colliders), s.start.x, s.handles);
  return {shot, scene.fps};
}

Run run(const Shot& shot, const MethodChoice& method, const Case& c, double fps) {
  AnimateOptions options;
  options.fps = fps;
  options.last_frame = c.last_frame;
  options.elastic.forces.gravity = c.gravity;
  const PatternSamples samples(shot.pattern, grid);
  Run r;
  animate(shot, method, options, [&](const AnimatedFrame& f) {
    r.frames.push_back(samples(*f.sheet));
    r.normals.push_back(samples.normals(*f.sheet));
    r.accepted += f.statistics.remesh == FrameStatistics::accepted;
    r.rejected += f.statistics.remesh == FrameStatistics::rejected;
    if (f.statistics.remesh == FrameStatistics::accepted)
      r.rise = std::max(r.rise, 100 * f.statistics.remesh_rise);
    const LengthDistortion d = length_distortion(*f.sheet);
    r.triangles += f.sheet->triangles.rows();
    r.elastic_ms += f.statistics.elastic_ms;
    r.geometry_ms += f.statistics.geometry_ms;
    r.worst_ms = std::max(r.worst_ms, f.statistics.elastic_ms + f.statistics.geometry_ms);
    r.c_m += 100 * d.mean;
    r.edge = std::max(r.edge, 100 * d.largest);
    r.iterations += f.statistics.newton_iterations;
    r.singular = static_cast<int>(f.sheet->singular.size());
    return true;
  });
  const double n = static_cast<double>(r.frames.size());
  r.triangles /= n;
  r.elastic_ms /= n;
  r.geometry_ms /= n;
  r.c_m /= n;
  r.iterations /= n;
  return r;
}

double rms_pct(const Run& a, const Run& b, double side) {
  double sum = 0;
  for (std::size_t f = 0; f < a.frames.size(); ++f) sum += rms_distance(a.frames[f], b.frames[f]);
  return 100 * sum / side / a.frames.size();
}

double normals_deg(const Run& a, const Run& b) {
  double sum = 0;
  for (std::size_t f = 0; f < a.normals.size(); ++f)
    sum += a.normals[f]
               .cwiseProduct(b.normals[f])
               .rowwise()
               .sum()
               .array()
               .min(1)
               .max(-1)
               .acos()
               .mean();
  return sum / a.normals.size() * 180 / M_PI;
}

Run run_fem(const Shot& shot, int triangles, const Case& c, double fps) {
  const char* folder = std::getenv("BENCH_CACHE");
  const std::string path =
      std::string(folder ? folder : "") + "/" + c.name + "_" + std::to_string(triangles) + ".run";
  const Eigen::Index size = 3 * grid * grid;
  Run r;
  if (std::ifstream file(path, std::ios::binary); folder && file) {
    file.read(reinterpret_cast<char*>(static_cast<Numbers*>(&r)), sizeof(Numbers));
    r.frames.assign(c.last_frame, Points3(grid * grid, 3));
    r.normals = r.frames;
    for (auto* all : {&r.frames, &r.normals})
      for (Points3& p : *all) file.read(reinterpret_cast<char*>(p.data()), size * sizeof(double));
    if (file) return r;
  }
  r = run(shot, fem(triangles), c, fps);
  if (!folder) return r;
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(static_cast<const Numbers*>(&r)), sizeof(Numbers));
  for (const auto* all : {&r.frames, &r.normals})
    for (const Points3& p : *all)
      file.write(reinterpret_cast<const char*>(p.data()), size * sizeof(double));
  return r;
}

std::vector<Case> cases_named(const std::vector<std::string>& words) {
  std::vector<Case> named;
  for (const Case& c : cases)
    if (words.empty() || std::any_of(words.begin(), words.end(), [&](const std::string& w) {
          return std::string(c.name).rfind(w, 0) == 0;
        }))
      named.push_back(c);
  return named;
}

}  // namespace paperbake::bench
