// Table: is the shape the same whatever the settings? Quasi-static handles go the same way in other
// steps, at other speeds and on other first meshes.
//
//   build/paperbake_invariance [METHOD... [SCENE...]]
//
// METHOD: hybrid, adaptive, fem, fem6000; default: all but fem6000. RMS over 41 x 41 points of the
// pattern in % of the longer side, mean over every fourth frame: each change against the scene as
// it is, and the two runs that are farthest apart. Elastic paper. BENCH_FRAMES=1 in the environment
// prints every frame.

#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/bench/against_fem.h"
#include "tests/bench/invariance.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace paperbake::bench {
namespace {

const std::map<std::string, MakeMethod> methods{
    {"hybrid",
     [](const Shot& shot, double turn) {
       return hybrid(shot.pattern, shot.paper, {120, turn}, {}, 0, 0);
     }},
    {"adaptive",
     [](const Shot& shot, double turn) {
       SizingOptions options;
       options.turn = turn;
       return adaptive(shot.pattern, 3000, options);
     }},
    {"fem",
     [](const Shot&, double turn) {
       return fem({1700, turn});
     }},
    {"fem6000", [](const Shot&, double turn) {
       return fem({6000, turn});
     }}};

void print_row(const std::string& method, const Case& c) {
  const auto [shot, fps] = shot_of(c);
  std::vector<Shapes> runs;
  for (const Change& change : changes())
    runs.push_back(shapes_of(shot, methods.at(method), change, c.gravity, fps, c.last_frame));
  std::printf("%-11s %-9s", c.name, method.c_str());
  for (std::size_t k = 1; k < runs.size(); ++k)
    std::printf(" %11.3f", apart_pct(runs[0], runs[k], shot.pattern));
  double most = 0;
  std::pair<std::size_t, std::size_t> farthest;
  for (std::size_t a = 0; a < runs.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (const double apart = apart_pct(runs[a], runs[b], shot.pattern); apart > most) {
        most = apart;
        farthest = {b, a};
      }
  std::printf("   %.3f: %s, %s\n", most, changes()[farthest.first].name,
              changes()[farthest.second].name);
  if (std::getenv("BENCH_FRAMES"))
    for (std::size_t f = 0; f < runs[0].frames.size(); ++f) {
      std::printf("  frame %2zu           ", 4 * (f + 1));
      for (std::size_t k = 1; k < runs.size(); ++k)
        std::printf(" %11.3f", 100 / longer_side(shot.pattern) *
                                   rms_distance(runs[0].frames[f], runs[k].frames[f]));
      std::printf("\n");
    }
  std::fflush(stdout);
}

}  // namespace
}  // namespace paperbake::bench

int main(int argc, char** argv) {
  using namespace paperbake::bench;
  std::vector<std::string> named, scenes;
  for (int a = 1; a < argc; ++a) (methods.count(argv[a]) ? named : scenes).push_back(argv[a]);
  if (named.empty()) named = {"hybrid", "adaptive", "fem"};
  std::printf("%-21s", "% of the sheet");
  for (std::size_t k = 1; k < changes().size(); ++k) std::printf(" %11s", changes()[k].name);
  std::printf("   any two\n");
  for (const std::string& method : named)
    for (const Case& c : cases_named(scenes)) print_row(method, c);
}
