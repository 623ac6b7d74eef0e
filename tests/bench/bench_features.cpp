// Table: which features are at work in the sample scenes, why, and what they cost.
//
//   build/paperbake_features [REPEATS [SCENE...]]
//
// CPU time of one thread, the least of REPEATS (default 5) interleaved runs. Hybrid as `paperbake
// bake` runs it. A row shows whether a feature is at work and why, the ms per frame of the scene,
// how many of these are saved when the feature is switched off, and how far that moves the sheet
// (RMS over 41 x 41 points, mean over the frames, in % of the longer side).

#include "core/animation/inertia_need.h"
#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
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
  int last_frame = 1000;  // of the scene
};
constexpr Case cases[] = {{"S1_push", 0, 40}, {"S1_push", 0},  {"S2_moebius", 0}, {"S4_crumple", 0},
                          {"S5_roll", 9.81},  {"S8_dcone", 0}, {"S9_unload", 0}};

/// What may be switched off; dynamics, colliders and polish are off in all runs.
enum Feature { plasticity = 1, singular_points = 2, contact = 4, all = 7 };

struct Run {
  double ms = INFINITY;  // per frame
  std::vector<Points3> frames;
  int touching = 0, births = 0;  // number of frames; number of points
  double plastic = 0;            // [m rad]
};

void play(const Shot& shot, const AnimateOptions& as_baked, int off, Run& run) {
  AnimateOptions options = as_baked;
  if (off & plasticity) options.plasticity = Plasticity::off;
  if (off & contact) options.elastic.contact = SelfContact::off;
  CrumpleOptions crumple;
  if (off & singular_points) crumple.max_points = 0;
  const PatternSamples samples(shot.pattern);
  const bool first_time = run.frames.empty();
  double ms = 0;
  int frames = 0;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, crumple, 0, 0), options,
          [&](const AnimatedFrame& f) {
            ms += f.statistics.elastic_ms + f.statistics.geometry_ms;
            ++frames;
            if (!first_time) return true;
            run.frames.push_back(samples(*f.sheet));
            run.touching += f.statistics.touching > 0;
            run.births += f.statistics.new_singular;
            run.plastic = f.statistics.plastic;
            return true;
          });
  run.ms = std::min(run.ms, ms / frames);
}

double apart_pct(const Run& a, const Run& b, double side) {
  double sum = 0;
  const std::size_t frames = std::min(a.frames.size(), b.frames.size());
  for (std::size_t f = 0; f < frames; ++f) sum += rms_distance(a.frames[f], b.frames[f]);
  return 100 * sum / side / frames;
}

void print_scene(const Case& c, int repeats) {
  const Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + c.name + ".glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  const double side = longer_side(shot.pattern);
  AnimateOptions options;
  options.fps = scene.fps;
  options.first_frame = scene.first_frame;
  options.last_frame = std::min(scene.last_frame, c.last_frame);
  options.elastic.forces.gravity = c.gravity;
  options.plasticity = Plasticity::on;
  const InertiaNeed inertia =
      need_of_inertia(shot, {c.gravity}, scene.fps, scene.first_frame, scene.last_frame);
  if (inertia.needed) options.elastic.inertia = Inertia::dynamic;

  const int sets[] = {0, plasticity, singular_points, contact, all};
  Run runs[std::size(sets)];
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t k = 0; k < std::size(sets); ++k) play(shot, options, sets[k], runs[k]);
  const Run& as_baked = runs[0];
  const auto row = [&](const char* feature, bool on, const std::string& why) {
    std::printf("  %-16s %-3s %-100s", feature, on ? "on" : "off", why.c_str());
  };
  const auto cost = [&](const Run& without) {
    std::printf(" %+7.3f ms  %.4f %%\n", as_baked.ms - without.ms,
                apart_pct(as_baked, without, side));
  };
  std::printf(
      "%s, frames 1-%d: %.3f ms a frame; everything forced off %.3f ms: %.3f times, moved %.4f "
      "%%\n",
      c.name, options.last_frame, as_baked.ms, runs[4].ms, as_baked.ms / runs[4].ms,
      apart_pct(as_baked, runs[4], side));
  char text[120];
  row("dynamics", inertia.needed, inertia.why);
  std::printf("\n");
  std::snprintf(text, sizeof text, "%.4f m rad stay bent", as_baked.plastic);
  row("plasticity", as_baked.plastic > 0, as_baked.plastic > 0 ? text : "no fibre yields");
  cost(runs[1]);
  std::snprintf(text, sizeof text, "%d born where two bending directions conflict",
                as_baked.births);
  row("singular points", as_baked.births > 0,
      as_baked.births ? text : "no two bending directions conflict for long");
  cost(runs[2]);
  std::snprintf(text, sizeof text, "the sheet touches itself in %d frames", as_baked.touching);
  row("contact", as_baked.touching > 0,
      as_baked.touching ? text : "the sheet never touches itself");
  cost(runs[3]);
  row("colliders", false, scene.colliders.empty() ? "none in scene" : "left out here");
  std::printf("\n");
  row("polish", false, "frames are handed on as simulated");
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  using namespace paperbake;
  const int repeats = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  for (const Case& c : cases) {
    const bool named = std::any_of(argv + std::min(argc, 2), argv + argc, [&](const char* word) {
      return std::string(c.name).rfind(word, 0) == 0;
    });
    if (argc <= 2 || named) print_scene(c, repeats);
  }
}
