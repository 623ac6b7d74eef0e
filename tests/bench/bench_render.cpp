// Table: the mesh for the whole shot on the sample scenes.
//
//   build/paperbake_bench_render [SCENE...]
//
// CPU time of one thread, means over the frames of a hybrid bake.
//   sim, render  triangles
//   mesh s       time for the mesh and its factor, once
//   ms           for a frame: positions + normals; per 100k: the same for 100,000 triangles
//   c_m          mean |l - L|/L over the edges in %: mean over the frames, worst frame; worst edge
//                of the worst frame
//   simulated    c_m of the simulated meshes
//   far          largest distance of a vertex from the flat simulated triangles, in % of the longer
//                side
//   crossings    (BENCH_CROSSINGS=1) pairs of triangles that pass through each other, by frame
//   Ub           (BENCH_POLISH=1, every 12th frame before the third singular point: a crumple has
//                no equilibrium near by) bending energy over that of the same frame brought to its
//                minimum on this mesh with the plastic curvature of that frame; and by how far this
//                moves it, RMS in % of the longer side
// Environment: BENCH_QUALITY="draft shot hero"; BENCH_ELASTIC=1: paper that does not yield

#include "core/animation/animate.h"
#include "core/animation/cpu_clock.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/hybrid.h"
#include "core/model/plastic_grid.h"
#include "core/render/render_surface.h"
#include "core/render/shot_record.h"
#include "formats/scene/scene_file.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace paperbake {
namespace {

struct Case {
  const char* name;
  int last_frame;
  double gravity;
};
constexpr Case cases[] = {{"S1_push", 60, 0},      {"S2_moebius", 72, 0}, {"S4_crumple", 96, 0},
                          {"S4r_release", 144, 0}, {"S5_roll", 72, 9.81}, {"S8_dcone", 96, 0},
                          {"S9_unload", 120, 0},   {"S10_ball", 132, 0}};

/// Plastic curvature of the paper at a frame: for each triangle of the simulated mesh the mean of
/// its corners.
PlasticGrid remembered(const Pattern& pattern, const Sheet& sheet, const Points3& plastic) {
  PlasticGrid grid(pattern);
  if (plastic.rows() == 0) return grid;
  PlasticMemory memory(static_cast<int>(sheet.triangles.rows()));
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    memory.curvature.row(t) =
        (plastic.row(sheet.triangles(t, 0)) + plastic.row(sheet.triangles(t, 1)) +
         plastic.row(sheet.triangles(t, 2))) /
        3;
  grid.write(grid.cover(sheet.pattern, sheet.triangles), memory);
  return grid;
}

struct Polished {
  double ratio;  // bending energy of a frame over that of the nearest minimum
  double moved;  // [m] RMS
};
Polished polish(const Sheet& sheet, const std::vector<int>& vertices, const Case& c,
                PlasticGrid grid) {
  ElasticOptions options;
  options.forces.gravity = c.gravity;
  options.contact = SelfContact::off;
  Elastic elastic(Paper{}, options);
  elastic.set_plastic_grid(&grid);
  Sheet polished = sheet;
  elastic.set_mesh(polished);
  const ElasticReport before = elastic.evaluate_energies(polished);
  PositionConstraints held;
  for (const int v : vertices)
    if (std::none_of(held.begin(), held.end(),
                     [&](const PositionConstraint& c) { return c.vertex == v; }))
      held.push_back({v, sheet.x.row(v)});
  const ElasticReport after = elastic.relax(polished, {held}, 1.0 / 24, Relaxation::full);
  return {(before.energy - before.membrane) / (after.energy - after.membrane),
          rms_distance(polished.x, sheet.x)};
}

/// What the paper remembers in the frames that can be polished: those before the third singular
/// point.
struct SmoothFrames {
  std::vector<Points3> plastic;  // for each frame, at the vertices of its mesh
};

/// Facets of frames that intersect others on the render mesh, as the render pass looks for them.
std::set<ShotRecord::SimulatedTriangle> intersecting_triangles(const RenderSurface& render,
                                                               const ShotRecord& record) {
  std::set<ShotRecord::SimulatedTriangle> triangles;
  for (const RecordedFrame& f : record.frames()) {
    const Sheet sheet = record.sheet(f);
    if (!render.may_have_intersecting_triangles(sheet)) continue;
    for (const int t :
         render.intersecting_triangles(sheet, render.locate_on(sheet.pattern, sheet.triangles)))
      triangles.insert({f.mesh, t});
  }
  return triangles;
}

void measure(const Shot& shot, const ShotRecord& record, const SmoothFrames& smooth, const Case& c,
             const std::string& name) {
  const Quality quality = name == "draft"  ? Quality::draft
                          : name == "hero" ? Quality::hero
                                           : Quality::shot;
  double begun = cpu_ms();
  RenderFeatures features = record.features(shot);
  RenderSurface render = make_render_surface(shot.pattern, features, record.edge(), quality);
  if (const auto triangles = intersecting_triangles(render, record); !triangles.empty()) {
    features.edges = record.edges(triangles);
    render = make_render_surface(shot.pattern, features, record.edge(), quality);
  }
  const double mesh_ms = cpu_ms() - begun;
  const double n = static_cast<double>(record.frames().size()), side = longer_side(shot.pattern);
  double ms = 0, place_ms = 0, mean = 0, worst_mean = 0, worst = 0, simulated = 0, far = 0,
         hold_ms = 0;
  int worst_frame = 0;
  std::vector<MeshPoint> places;
  int mesh = -1;
  std::string energies, crossed;
  for (const RecordedFrame& f : record.frames()) {
    const Sheet sheet = record.sheet(f);
    begun = cpu_ms();
    render.hold(f.held);
    hold_ms += cpu_ms() - begun;
    begun = cpu_ms();
    if (f.mesh != mesh) places = render.locate_on(sheet.pattern, sheet.triangles);
    place_ms += cpu_ms() - begun;
    mesh = f.mesh;
    begun = cpu_ms();
    const RenderFrame frame = render.frame(sheet, places, f.held_at);
    ms += cpu_ms() - begun;
    const Sheet shown{render.mesh().pattern,
                      frame.x,
                      Points3::Zero(frame.x.rows(), 3),
                      render.mesh().triangles,
                      {}};
    const LengthDistortion d = length_distortion(shown);
    mean += 100 * d.mean / n;
    simulated += 100 * length_distortion(sheet).mean / n;
    if (100 * d.mean > worst_mean) {
      worst_mean = 100 * d.mean;
      worst_frame = f.frame;
    }
    worst = std::max(worst, 100 * d.largest);
    for (std::size_t v = 0; v < places.size(); ++v)
      far = std::max(
          far, 100 / side *
                   (interpolate(places[v], sheet.triangles, sheet.x) - frame.x.row(v).transpose())
                       .norm());
    if (std::getenv("BENCH_CROSSINGS"))
      if (const int pairs = crossings(shown); pairs > 0)
        crossed += " " + std::to_string(f.frame) + ":" + std::to_string(pairs);
    const auto index = static_cast<std::size_t>(&f - record.frames().data());
    if (std::getenv("BENCH_POLISH") && f.frame % 12 == 0 && index < smooth.plastic.size()) {
      std::vector<int> held;
      for (const int h : f.held) held.push_back(render.mesh().point_vertex[h]);
      const Points3& kept = smooth.plastic[index];
      const auto [ratio, moved] = polish(shown, held, c, remembered(shot.pattern, sheet, kept));
      char text[60];
      std::snprintf(text, sizeof text, " %d:%.2f (%.2f %%)", f.frame, ratio, 100 * moved / side);
      energies += text;
    }
  }
  const double triangles = static_cast<double>(render.mesh().triangles.rows());
  std::printf(
      "  %-6s render %6.0f  creases %4zu  mesh %.1f s  hold %.0f  ms %.2f + places %.2f  per 100k "
      "%.1f  c_m %.4f worst %.4f (f%d) edge %.2f  simulated %.4f  far %.2f %%%s%s%s%s\n",
      name.c_str(), triangles, render.mesh().creases.size(), 1e-3 * mesh_ms, hold_ms, ms / n,
      place_ms / n, 1e5 * (ms + place_ms) / n / triangles, mean, worst_mean, worst_frame, worst,
      simulated, far, crossed.empty() ? "" : "  crossings", crossed.c_str(),
      energies.empty() ? "" : "  Ub", energies.c_str());
  std::fflush(stdout);
}

void run(const Case& c) {
  const Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + c.name + ".glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = c.last_frame;
  options.elastic.forces.gravity = c.gravity;
  options.plasticity = std::getenv("BENCH_ELASTIC") ? Plasticity::off : Plasticity::on;
  ShotRecord record;
  SmoothFrames smooth;
  int singular_points = 0;
  double triangles = 0;
  try {
    animate(shot, hybrid(shot.pattern, shot.paper, 120, CrumpleOptions{}, 0, 0), options,
            [&](const AnimatedFrame& f) {
              record.add(f);
              singular_points += f.statistics.new_singular;
              if (singular_points < 3) smooth.plastic.push_back(f.plastic_curvature);
              triangles += static_cast<double>(f.sheet->triangles.rows());
              return true;
            });
  } catch (const std::exception& error) {
    std::printf("  %s\n", error.what());
  }
  std::printf("%s, %zu frames, sim %.0f triangles of %.1f mm, %zu meshes\n", c.name,
              record.frames().size(), triangles / record.frames().size(), 1e3 * record.edge(),
              record.meshes().size());
  std::istringstream words(std::getenv("BENCH_QUALITY") ? std::getenv("BENCH_QUALITY")
                                                        : "draft shot hero");
  for (std::string word; words >> word;) measure(shot, record, smooth, c, word);
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  for (const auto& c : paperbake::cases) {
    bool wanted = argc < 2;
    for (int i = 1; i < argc; ++i) wanted |= std::string(c.name).rfind(argv[i], 0) == 0;
    if (wanted) paperbake::run(c);
  }
}
