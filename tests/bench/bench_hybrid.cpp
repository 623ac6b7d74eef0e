// Table: hybrid against the finest fem on the sample scenes.
//
//   build/paperbake_bench_hybrid [REFERENCE_TRIANGLES [SCENE...]]
//
// CPU time of one thread. All distances are over 41 x 41 points of the pattern, in % of the longer
// side.
//   rms    distance from the sheet of fem, mean over the frames; for hybrid with three base
//          densities: mean [smallest, largest]
//   nrm    angle between the shading normals, mean over points and frames [degrees]
//   jit    RMS of x_f - 2 x_{f-1} + x_{f-2}: median / 90 % quantile over the frames
//   ruled  ruled meshes accepted - rejected, and the largest rise of the potential at an accepted
//          one
// Environment:
//   BENCH_BASES="60 75 90"                     base densities
//   BENCH_CACHE=DIR                            keeps the runs of fem there for the next time
//   BENCH_SET="turn_per_ruling=0.2 flip_gain=0.5"   options; turn_per_ruling=0: no ruled meshes
//   BENCH_FRAMES=1                             rms of every frame

#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/methods/hybrid.h"
#include "tests/bench/against_fem.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <map>
#include <sstream>

namespace paperbake::bench {
namespace {

std::vector<double> jitter_pct(const Run& r, double side) {
  std::vector<double> all;
  for (std::size_t f = 2; f < r.frames.size(); ++f)
    all.push_back(
        100 / side *
        std::sqrt(
            (r.frames[f] - 2 * r.frames[f - 1] + r.frames[f - 2]).rowwise().squaredNorm().mean()));
  std::sort(all.begin(), all.end());
  return all;
}

void print_row(const std::string& label, const Run& r, const Run& reference, double side) {
  const std::vector<double> jitter = jitter_pct(r, side);
  std::printf(
      "  %-10s %5.0f %7.2f + %.2f (%6.1f) %5.1f it  c_m %.4f edge %.3f sing %2d  ruled %d-%d %+.1f "
      "%%  jit %.3f/%.2f  nrm %.2f  rms %.3f %%\n",
      label.c_str(), r.triangles, r.elastic_ms, r.geometry_ms, r.worst_ms, r.iterations, r.c_m,
      r.edge, r.singular, r.accepted, r.rejected, r.rise, jitter[jitter.size() / 2],
      jitter[jitter.size() * 9 / 10], normals_deg(r, reference), rms_pct(r, reference, side));
  std::fflush(stdout);
}

CrumpleOptions options_set() {
  CrumpleOptions o;
  RulingOptions& r = o.rulings;
  const std::map<std::string, double*> by_name{
      {"flip_gain", &o.flip_gain},
      {"conflict_turn", &o.conflict_turn},
      {"turn_per_ruling", &r.turn_per_ruling},
      {"curved_above", &r.curved_above},
      {"coherent", &r.coherent},
      {"window", &r.window},
      {"cylinder_regularization", &r.cylinder_regularization},
      {"across_most", &r.across_most},
      {"across_least", &r.across_least},
      {"along_most", &r.along_most},
      {"merge_distance", &r.merge_distance},
      {"guard", &r.guard},
      {"stale_fold", &r.stale_fold},
      {"max_share", &r.max_share}};
  const char* given = std::getenv("BENCH_SET");
  std::istringstream words(given ? given : "");
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    *by_name.at(word.substr(0, equals)) = std::stod(word.substr(equals + 1));
  }
  return o;
}

std::vector<int> bases() {
  const char* given = std::getenv("BENCH_BASES");
  std::istringstream words(given ? given : "75 90 105");
  return {std::istream_iterator<int>(words), {}};
}

void compare(const Case& c, int reference_triangles) {
  const auto [shot, fps] = shot_of(c);
  const double side = longer_side(shot.pattern);
  std::printf("%s, frames 1-%d\n  %-10s %5s %7s\n", c.name, c.last_frame, "", "tri",
              "elastic + geometry ms (worst)");
  const Run reference = run_fem(shot, reference_triangles, c, fps);
  print_row("fem", reference, reference, side);
  print_row("fem", run_fem(shot, 1700, c, fps), reference, side);
  const CrumpleOptions options = options_set();
  Numbers mean;
  double sum = 0, normals = 0, least = 1e9, most = 0;
  for (const int base : bases()) {
    const Run h = run(shot, hybrid(shot.pattern, shot.paper, base, options, 0, 0), c, fps);
    const double rms = rms_pct(h, reference, side);
    print_row("hybrid " + std::to_string(base), h, reference, side);
    if (std::getenv("BENCH_FRAMES"))
      for (std::size_t f = 0; f < h.frames.size(); ++f)
        std::printf("    frame %2zu rms %.3f %%\n", f + 1,
                    100 / side * rms_distance(h.frames[f], reference.frames[f]));
    sum += rms;
    least = std::min(least, rms);
    most = std::max(most, rms);
    normals += normals_deg(h, reference);
    mean.triangles += h.triangles;
    mean.elastic_ms += h.elastic_ms;
    mean.geometry_ms += h.geometry_ms;
  }
  const double n = static_cast<double>(bases().size());
  std::printf("  hybrid: %.0f tri, %.2f + %.2f ms, nrm %.2f deg, rms %.3f [%.3f, %.3f] %%\n",
              mean.triangles / n, mean.elastic_ms / n, mean.geometry_ms / n, normals / n, sum / n,
              least, most);
}

}  // namespace
}  // namespace paperbake::bench

int main(int argc, char** argv) {
  for (const auto& c : paperbake::bench::cases_named({argv + std::min(argc, 2), argv + argc}))
    paperbake::bench::compare(c, argc > 1 ? std::atoi(argv[1]) : 6000);
}
