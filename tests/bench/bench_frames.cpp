// Table: which frames of a shot are the most expensive, and why.
//
//   build/paperbake_bench_frames [SCENE [BASE [SEED [LAST_FRAME]]]]
//
// SCENE: all | S1_push, ...; default: all scenes, base 120, seed 0, up to the last frame. Hybrid as
// in a bake (plasticity, contact), CPU time of one thread. There is a line for each of the five
// most expensive frames of a shot. Environment:
//   BENCH_FRAMES=1   a line for every frame
//   BENCH_PROBE=N    a search for other branches every N frames

#include "core/animation/animate.h"
#include "core/geometry/measure.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace paperbake {
namespace {

struct Case {
  const char* name;
  double gravity;
};
constexpr Case cases[] = {{"S1_push", 0},  {"S2_moebius", 0}, {"S3_unload", 0},  {"S5_roll", 9.81},
                          {"S8_dcone", 0}, {"S9_unload", 0},  {"S4r_release", 0}};

struct Row {
  int frame, triangles, iterations, substeps, touching, births;
  double elastic_ms, geometry_ms, energy, lag, edge;
  bool contact, converged;
  FrameStatistics::Remesh remesh;
  std::string note;
  double ms() const { return elastic_ms + geometry_ms; }
};

void print(const Row& r) {
  constexpr const char* proposal[] = {"", ", proposal taken", ", proposal refused"};
  std::printf(
      "  f%-3d %6.1f + %5.1f ms  %3d it%s  %3d tri  %.4e J  lag %.2f mm  edge %.2f %%%s%s%s%s%s\n",
      r.frame, r.elastic_ms, r.geometry_ms, r.iterations, r.converged ? "" : " unfinished",
      r.triangles, r.energy, r.lag, r.edge, r.contact ? ", contact" : "",
      r.substeps > 1 ? (", " + std::to_string(r.substeps) + " substeps").c_str() : "",
      proposal[r.remesh], r.births ? ", birth" : "", r.note.empty() ? "" : (", " + r.note).c_str());
}

void show(const Case& c, int base, unsigned seed, int last_frame) {
  const Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + c.name + ".glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = std::min(scene.last_frame, last_frame);
  options.seed = seed;
  options.plasticity = Plasticity::on;
  options.elastic.forces.gravity = c.gravity;
  if (const char* every = std::getenv("BENCH_PROBE")) options.probe_every = std::atoi(every);
  std::vector<Row> rows;
  double shape = 0;  // shows whether two versions of the program animate the same
  animate(shot, hybrid(shot.pattern, shot.paper, base, {}, seed, 0), options,
          [&](const AnimatedFrame& f) {
            Row r{f.frame,
                  static_cast<int>(f.sheet->triangles.rows()),
                  f.statistics.newton_iterations,
                  f.statistics.substeps,
                  f.statistics.touching,
                  f.statistics.new_singular,
                  f.statistics.elastic_ms,
                  f.statistics.geometry_ms,
                  f.statistics.energy,
                  0,
                  100 * length_distortion(*f.sheet).largest,
                  f.statistics.contact,
                  f.statistics.converged,
                  f.statistics.remesh,
                  f.note};
            for (const HandleFrame& h : f.handles)
              if (h.state != HandleFrame::free)
                r.lag = std::max(r.lag, 1e3 * (h.at - h.keyed).norm());
            rows.push_back(r);
            shape += f.sheet->x.squaredNorm();
            return true;
          });
  std::vector<Row> worst = rows;
  std::sort(worst.begin(), worst.end(), [](const Row& a, const Row& b) { return a.ms() > b.ms(); });
  double sum = 0, iterations = 0;
  for (const Row& r : rows) {
    sum += r.ms();
    iterations += r.iterations;
  }
  std::printf(
      "%s, base %d, seed %u: mean %.2f ms, %.1f it; worst %.1f, median %.1f ms; shape %.17g\n",
      c.name, base, seed, sum / rows.size(), iterations / rows.size(), worst.front().ms(),
      worst[worst.size() / 2].ms(), shape);
  if (!std::getenv("BENCH_FRAMES"))
    rows.assign(worst.begin(), worst.begin() + std::min<std::size_t>(5, worst.size()));
  for (const Row& r : rows) print(r);
  std::fflush(stdout);
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  const std::string scene = argc > 1 ? argv[1] : "all";
  for (const auto& c : paperbake::cases)
    if (scene == "all" || std::string(c.name).rfind(scene, 0) == 0)
      paperbake::show(c, argc > 2 ? std::atoi(argv[2]) : 120, argc > 3 ? std::atoi(argv[3]) : 0,
                      argc > 4 ? std::atoi(argv[4]) : 1 << 20);
}
