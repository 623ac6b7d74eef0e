// Table: adaptive remeshing against the finest fem on the sample scenes, next to hybrid and to fem
// with as many triangles.
//
//   build/paperbake_bench_adaptive [REFERENCE_TRIANGLES [SCENE...]]
//
// Elastic paper, CPU time of one thread. The columns are those of bench_hybrid.cpp. Environment:
//   BENCH_CACHE=DIR                        keeps the runs of fem there for the next time
//   BENCH_SET="edge_turn=0.15 aspect=3"   options of the sizing field
//   BENCH_FRAMES=1                         rms of every frame

#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/methods/adaptive.h"
#include "core/methods/hybrid.h"
#include "tests/bench/against_fem.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>

namespace paperbake::bench {
namespace {

SizingOptions options_set() {
  SizingOptions o;
  const std::map<std::string, double*> by_name{{"edge_turn", &o.edge_turn},
                                               {"largest", &o.largest},
                                               {"smallest", &o.smallest},
                                               {"aspect", &o.aspect},
                                               {"growth", &o.growth}};
  const char* given = std::getenv("BENCH_SET");
  std::istringstream words(given ? given : "");
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    *by_name.at(word.substr(0, equals)) = std::stod(word.substr(equals + 1));
  }
  return o;
}

void print_row(const char* label, const Run& r, const Run& reference, double side) {
  std::printf(
      "  %-8s %5.0f %7.2f + %.2f (%6.1f) %5.1f it  c_m %.4f edge %.3f  nrm %.2f  rms %.3f %%\n",
      label, r.triangles, r.elastic_ms, r.geometry_ms, r.worst_ms, r.iterations, r.c_m, r.edge,
      normals_deg(r, reference), rms_pct(r, reference, side));
  std::fflush(stdout);
}

void compare(const Case& c, int reference_triangles) {
  const auto [shot, fps] = shot_of(c);
  const double side = longer_side(shot.pattern);
  std::printf("%s, frames 1-%d\n  %-8s %5s %7s\n", c.name, c.last_frame, "", "tri",
              "elastic + geometry ms (worst)");
  const Run reference = run_fem(shot, reference_triangles, c, fps);
  const Run a = run(shot, adaptive(shot.pattern, 3000, options_set()), c, fps);
  print_row("adaptive", a, reference, side);
  if (std::getenv("BENCH_FRAMES"))
    for (std::size_t f = 0; f < a.frames.size(); ++f)
      std::printf("    frame %2zu rms %.3f %%\n", f + 1,
                  100 / side * rms_distance(a.frames[f], reference.frames[f]));
  print_row("fem", run_fem(shot, 10 * static_cast<int>(std::lround(a.triangles / 10)), c, fps),
            reference, side);
  print_row("fem", run_fem(shot, 1700, c, fps), reference, side);
  print_row("hybrid", run(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), c, fps), reference,
            side);
}

}  // namespace
}  // namespace paperbake::bench

int main(int argc, char** argv) {
  for (const auto& c : paperbake::bench::cases_named({argv + std::min(argc, 2), argv + argc}))
    paperbake::bench::compare(c, argc > 1 ? std::atoi(argv[1]) : 6000);
}
