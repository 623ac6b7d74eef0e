// Tables: how many facets a crumple has, and how long its creases are, beside the law of
// [Andrejevic 2021]; and what the facets of smooth and crumpled sheets carry.
//
//   build/paperbake_bench_facets [SEEDS [SCENE]]        default: 3 seeds, all scenes
//
// Hybrid with plasticity and contact, CPU time of one thread. S13 is the experiment of the law, as
// far as the sheet follows the lid of its can; S4r has the same compaction by handles.

#include "core/animation/animate.h"
#include "core/geometry/collider_facing.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/hybrid.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "formats/scene/scene_file.h"
#include "tests/bench/facets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {
namespace {

constexpr double crease = 10 * M_PI / 180;  // [rad] edges that turn by more part two facets
constexpr double tube_radius = 0.135;       // [1] of the side, in the experiment

/// Simulates a sample up to its last frame that is asked for.
void run(const std::string& name, unsigned seed, int last,
         const std::function<void(const AnimatedFrame&, const Paper&)>& look) {
  const Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + name + ".glb");
  const SceneSheet& s = scene.sheets.front();
  Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  shot.colliders = facing_colliders(scene.colliders, s.start.x, s.handles);
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = last;
  options.seed = seed;
  options.plasticity = Plasticity::on;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, seed, 0), options,
          [&](const AnimatedFrame& frame) {
            look(frame, shot.paper);
            return true;
          });
}

/// A sample at one frame, over the seeds.
struct Crumpled {
  std::vector<double> areas;  // [1] of the sheet, of the facets of all seeds
  double length = 0;          // [1] of the side, sum over the seeds
  double points = 0, edge = 0, ms = 0;
  int crossed = 0, unfinished = 0;  // frames so far
};

/// heights  [1] of the tube over the side, by frame
void beside_the_law(const std::string& name, int seeds, const std::map<int, double>& heights) {
  std::map<int, Crumpled> at;
  for (int seed = 1; seed <= seeds; ++seed) {
    Crumpled so_far;
    int frames = 0;
    run(name, seed, heights.rbegin()->first, [&](const AnimatedFrame& f, const Paper&) {
      const Sheet& sheet = *f.sheet;
      ++frames;
      so_far.edge = std::max(so_far.edge, 100 * length_distortion(sheet).largest);
      so_far.crossed += crossings(sheet) > 0;
      so_far.unfinished += !f.statistics.converged;
      so_far.ms += f.statistics.elastic_ms + f.statistics.geometry_ms;
      if (heights.count(f.frame) == 0) return;
      const Hinges hinges = find_hinges(sheet.triangles);
      const PlasticMemory memory =
          f.plastic_grid->read(f.plastic_grid->cover(sheet.pattern, sheet.triangles));
      const Facets facets =
          find_facets(sheet, hinges, plastic_turns(sheet, hinges, memory), crease);
      double area = 0;
      for (const double a : facets.area) area += a;
      Crumpled& c = at[f.frame];
      for (const double a : facets.area) c.areas.push_back(a / area);
      c.length += facets.crease_length / std::sqrt(area);
      c.points += double(sheet.singular.size());
      c.edge = std::max(c.edge, so_far.edge);
      c.crossed += so_far.crossed;
      c.unfinished += so_far.unfinished;
      c.ms += so_far.ms / frames;
    });
  }
  for (const auto& [frame, c] : at) {
    const FacetLaw law(heights.at(frame), tube_radius);
    std::printf(
        "  %-11s f%d height %.2f: facets %.0f law %.0f, length %.1f law %.1f, distance %.2f, "
        "points %.0f, edge %.2f %%, crossed %d, unfinished %d, %.0f ms\n",
        name.c_str(), frame, heights.at(frame), double(c.areas.size()) / seeds, law.facets(),
        c.length / seeds, law.crease_length(), distance_from_law(c.areas, law), c.points / seeds,
        c.edge, c.crossed, c.unfinished, c.ms / seeds);
    std::fflush(stdout);
  }
}

void loads(const std::string& name, const std::vector<int>& frames) {
  run(name, 1, frames.back(), [&](const AnimatedFrame& f, const Paper& paper) {
    if (std::count(frames.begin(), frames.end(), f.frame) == 0) return;
    const Sheet& sheet = *f.sheet;
    const Hinges hinges = find_hinges(sheet.triangles);
    ElasticEnergy energy(paper, sheet.pattern, sheet.triangles);
    energy.memory = f.plastic_grid->read(f.plastic_grid->cover(sheet.pattern, sheet.triangles));
    const Facets facets =
        find_facets(sheet, hinges, dihedral_angles(sheet.x, hinges.hinges), crease);
    const std::vector<FacetLoad> carried = facet_loads(
        sheet, hinges, facets, paper, energy.stress(sheet.x, Points3::Zero(sheet.x.rows(), 3)),
        energy.local_energies(sheet.x));
    double most = 0, lag = 0;
    int over = 0, stiff = 0;
    for (const FacetLoad& facet : carried) {
      most = std::max(most, facet.load);
      over += facet.load > 4;
      stiff += facet.load > 4 && facet.membrane_share > 1 / 3.0;
    }
    for (const HandleFrame& h : f.handles)
      if (h.state != HandleFrame::free) lag = std::max(lag, 1e3 * (h.at - h.keyed).norm());
    std::printf("  %-11s f%d: facets %d, most %.2f, over 4: %d, of them stiff %d, lag %.1f mm\n",
                name.c_str(), f.frame, int(carried.size()), most, over, stiff, lag);
    std::fflush(stdout);
  });
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  using namespace paperbake;
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 3;
  const auto is_wanted = [&](const std::string& scene) { return argc < 3 || scene == argv[2]; };
  std::printf("facets beside the law, %d seeds\n", seeds);
  const std::pair<const char*, std::map<int, double>> pressed[] = {
      {"S4r_release", {{96, 0.45}}},
      {"S13_tube", {{29, 0.95}, {33, 0.9}}},
  };
  for (const auto& [scene, heights] : pressed)
    if (is_wanted(scene)) beside_the_law(scene, seeds, heights);
  std::printf("\nloads of facets, seed 1\n");
  const std::pair<const char*, std::vector<int>> loaded[] = {
      {"S1_push", {24, 36}},
      {"S2_moebius", {24, 44}},
      {"S5_roll", {24, 44}},
      {"S8_dcone", {24, 44}},
      {"S4r_release", {24, 48, 60, 72, 84, 96}},
      {"S10_ball", {25, 50}},
      {"S13_tube", {25, 27, 29}},
  };
  for (const auto& [scene, frames] : loaded)
    if (is_wanted(scene)) loads(scene, frames);
}
