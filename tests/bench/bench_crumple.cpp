// Table: statistics of crumples, which no single run has.
//
//   build/paperbake_bench_crumple [SEEDS]        default: 12 seeds
//
// Hybrid with plasticity and contact, CPU time of one thread. First S4r and S9 for each seed, then
// how the plastic turn of S4 depends on the density of the mesh, then what a heavier grade changes.

#include "core/animation/animate.h"
#include "core/geometry/crease_network.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

namespace paperbake {
namespace {

struct Run {
  double triangles = 0, elastic_ms = 0, geometry_ms = 0, worst_ms = 0, c_m = 0, edge = 0, lag = 0,
         last_lag = 0;
  int frames = 0, crossed = 0, births = 0, unfinished = 0;
  std::map<int, double> plastic;  // [m rad] by frame
  double facet = 0;               // [m] sqrt(area / singular points)
  double crease = 0;              // [m] mean length of the creases at the end
};

Run run(const std::string& name, const Paper& paper, int base_triangles, int max_triangles,
        unsigned seed) {
  const Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + name + ".glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, paper};
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = scene.last_frame;
  options.seed = seed;
  options.plasticity = Plasticity::on;
  CrumpleOptions crumple;
  crumple.max_triangles = max_triangles;
  Run r;
  animate(shot, hybrid(shot.pattern, paper, base_triangles, crumple, seed, 0), options,
          [&](const AnimatedFrame& f) {
            const LengthDistortion d = length_distortion(*f.sheet);
            ++r.frames;
            r.triangles += f.sheet->triangles.rows();
            r.elastic_ms += f.statistics.elastic_ms;
            r.geometry_ms += f.statistics.geometry_ms;
            r.worst_ms = std::max(r.worst_ms, f.statistics.elastic_ms + f.statistics.geometry_ms);
            r.c_m += 100 * d.mean;
            r.edge = std::max(r.edge, 100 * d.largest);
            r.last_lag = 0;
            for (const HandleFrame& h : f.handles)
              if (h.state != HandleFrame::free)
                r.last_lag = std::max(r.last_lag, 1e3 * (h.at - h.keyed).norm());
            r.lag = std::max(r.lag, r.last_lag);
            r.crossed += crossings(*f.sheet) > 0;
            r.unfinished += !f.statistics.converged;
            r.births = static_cast<int>(f.sheet->singular.size());
            if (f.frame == options.last_frame) r.crease = crease_network(*f.sheet).mean();
            r.plastic[f.frame] = f.statistics.plastic;
            return true;
          });
  r.triangles /= r.frames;
  r.elastic_ms /= r.frames;
  r.geometry_ms /= r.frames;
  r.c_m /= r.frames;
  r.facet = std::sqrt(area(shot.pattern) / std::max(1, r.births));
  return r;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void by_seed(const std::string& name, int seeds) {
  std::printf(
      "%s by seed\n  seed  tri   elastic + geometry ms (worst)  c_m %%   edge %%  crossed  births  "
      "unfinished  lag mm  plastic m rad\n",
      name.c_str());
  std::vector<double> edges, times, lags, worst;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Run r = run(name, Paper{}, 120, 250, seed);
    std::printf("  %4d %4.0f %9.2f + %.2f (%5.1f) %14.4f %7.2f %8d %7d %11d %7.1f %9.3f\n", seed,
                r.triangles, r.elastic_ms, r.geometry_ms, r.worst_ms, r.c_m, r.edge, r.crossed,
                r.births, r.unfinished, r.lag, r.plastic.rbegin()->second);
    std::fflush(stdout);
    edges.push_back(r.edge);
    times.push_back(r.elastic_ms + r.geometry_ms);
    lags.push_back(r.lag);
    worst.push_back(r.worst_ms);
  }
  std::printf("  median: %.2f ms (worst frame %.1f), edge %.2f %%, most %.2f %%, lag %.1f mm\n\n",
              median(times), median(worst), median(edges),
              *std::max_element(edges.begin(), edges.end()), median(lags));
}

void by_density(int seeds) {
  std::printf(
      "S4: plastic turn by density of the mesh, mean of %d seeds [m rad]\n  base   tri     f24     "
      "f48     f72     f96\n",
      seeds);
  for (const int base : {150, 300, 600}) {
    std::map<int, double> mean;
    double triangles = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      Run r = run("S4_crumple", Paper{}, base, 2 * base, seed);
      for (const int f : {24, 48, 72, 96}) mean[f] += r.plastic[f] / seeds;
      triangles += r.triangles / seeds;
    }
    std::printf("  %4d %5.0f %7.3f %7.3f %7.3f %7.3f\n", base, triangles, mean[24], mean[48],
                mean[72], mean[96]);
    std::fflush(stdout);
  }
  std::printf("\n");
}

void by_grade(int seeds) {
  std::printf("S4r: heavier paper of the same fibres has larger facets, mean of %d seeds\n", seeds);
  for (const double grammage : {70, 105, 140, 200, 250, 300}) {
    Paper paper;
    const double factor = grammage / 70;
    paper.thickness *= factor;
    paper.area_density *= factor;
    paper.membrane_stiffness *= factor;
    paper.bending_stiffness *= factor * factor * factor;
    double births = 0, facet = 0, crease = 0, plastic = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Run r = run("S4r_release", paper, 120, 250, seed);
      births += double(r.births) / seeds;
      facet += r.facet / seeds;
      crease += r.crease / seeds;
      plastic += r.plastic.rbegin()->second / seeds;
    }
    std::printf(
        "  %3.0f g/m2, %3.0f um: %.1f singular points, %.0f mm apart, creases %.1f mm, plastic "
        "turn %.2f m rad\n",
        grammage, 1e6 * paper.thickness, births, 1e3 * facet, 1e3 * crease, plastic);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 12;
  paperbake::by_seed("S4r_release", seeds);
  paperbake::by_seed("S9_unload", std::min(seeds, 3));
  paperbake::by_density(std::min(seeds, 4));
  paperbake::by_grade(std::min(seeds, 6));
}
