// Table: how many facets a crumple has, and of which sizes, beside the law of [Andrejevic 2021].
//
//   build/paperbake_bench_facets [SEEDS]        default: 3 seeds

#include "core/animation/animate.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "formats/scene/scene_file.h"
#include "tests/bench/facets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace paperbake {
namespace {

void diagnose(const std::string& file, unsigned seed, int every, int last, bool contact, int base,
              int map_frame, bool fixed, double stop) {
  const Scene scene = read_scene(file);
  const SceneSheet& s = scene.sheets.front();
  Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  shot.colliders = facing_colliders(scene.colliders, s.start.x, s.handles);
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = last ? last : scene.last_frame;
  options.seed = seed;
  options.elastic.stop = stop;
  options.plasticity = Plasticity::on;
  if (!contact) options.elastic.contact = SelfContact::off;
  const double A = area(shot.pattern);
  double ms = 0, edge = 0;
  int unconverged = 0;
  std::printf("%s seed %u\n", file.c_str(), seed);
  animate(shot, fixed ? fem(base) : hybrid(shot.pattern, shot.paper, base, {}, seed, 0), options,
          [&](const AnimatedFrame& f) {
            const Sheet& sheet = *f.sheet;
            ms += f.statistics.elastic_ms + f.statistics.geometry_ms;
            edge = std::max(edge, 100 * length_distortion(sheet).largest);
            unconverged += !f.statistics.converged;
            if (f.frame % every != 0 && f.frame != options.last_frame) return true;
            const Hinges hinges = find_hinges(sheet.triangles);
            const PlasticMemory memory =
                f.plastic_grid->read(f.plastic_grid->cover(sheet.pattern, sheet.triangles));
            ElasticEnergy energy(shot.paper, sheet.pattern, sheet.triangles);
            energy.memory = memory;
            const std::vector<double> turns = dihedral_angles(sheet.x, hinges.hinges);
            const Facets plastic = find_facets(sheet, hinges, plastic_turns(sheet, hinges, memory),
                                               10 * M_PI / 180),
                         now = find_facets(sheet, hinges, turns, 10 * M_PI / 180);
            const auto loads = facet_loads(sheet, hinges, now, shot.paper,
                                           energy.stress(sheet.x, Points3::Zero(sheet.x.rows(), 3)),
                                           energy.local_energies(sheet.x));
            double most = 0, most_locked = 0;
            int over = 0, locked = 0;
            for (const FacetLoad& l : loads) {
              most = std::max(most, l.load);
              over += l.load > 1;
              locked += l.load > 1 && l.membrane_share > 1 / 3.0;
              if (l.membrane_share > 1 / 3.0) most_locked = std::max(most_locked, l.load);
            }
            double lag = 0;
            for (const HandleFrame& h : f.handles)
              if (h.state != HandleFrame::free) lag = std::max(lag, 1e3 * (h.at - h.keyed).norm());
            const double height = sheet.x.col(2).maxCoeff() - sheet.x.col(2).minCoeff();
            std::printf(
                "  f%3d tri %4d pts %3d | plastic N %3zu L %5.2f | now N %3zu L %5.2f | chi %8.2f "
                "(m>1/3 %8.2f) over %3d locked %3d | memb %.2f E %.2f mJ | lag %.1f edge %.2f h "
                "%.1f uncv %d cross %d ms %.1f\n",
                f.frame, int(sheet.triangles.rows()), int(sheet.singular.size()),
                plastic.area.size(), plastic.crease_length / std::sqrt(A), now.area.size(),
                now.crease_length / std::sqrt(A), most, most_locked, over, locked,
                f.statistics.membrane_energy / std::max(1e-12, f.statistics.energy),
                1e3 * f.statistics.energy, lag, edge, 1e3 * height, unconverged, crossings(sheet),
                ms / f.frame);
            std::fflush(stdout);
            if (f.frame == map_frame) {
              FILE* out = std::fopen("/tmp/facets_out/map.csv", "w");
              for (int t = 0; t < sheet.triangles.rows(); ++t) {
                const FacetLoad& l = loads[now.of_triangle[t]];
                for (int i = 0; i < 3; ++i)
                  std::fprintf(out, "%g,%g,", sheet.pattern(sheet.triangles(t, i), 0),
                               sheet.pattern(sheet.triangles(t, i), 1));
                std::fprintf(out, "%g,%g,%g,%g,%d\n", l.load, l.membrane_share, l.direction.x(),
                             l.direction.y(), now.of_triangle[t]);
              }
              std::fclose(out);
            }
            return true;
          });
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  // FILE seed every last contact base map fem
  const auto n = [&](int i, int d) { return argc > i ? std::atoi(argv[i]) : d; };
  paperbake::diagnose(argv[1], n(2, 0), n(3, 12), n(4, 0), n(5, 1), n(6, 120), n(7, 0), n(8, 0),
                      1e-5);
}
