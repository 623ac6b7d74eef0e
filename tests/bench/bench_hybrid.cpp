// Hybrid against the finest fem on the sample scenes: a table anyone can print.
//
//   build/paperbake_bench_hybrid [REFERENCE_TRIANGLES [SCENE...]]
//
// One thread, CPU time. RMS: distance to fem's sheet over a 41 x 41 grid of the pattern, in % of the longer side, mean over the
// frames; hybrid with three base densities: mean [least, most].

#include "core/animate.h"
#include "core/locate.h"
#include "core/measure.h"
#include "formats/scene_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace paperbake {
namespace {

constexpr int grid = 41;

struct Case {
  const char* name;
  int last_frame;
  double gravity;
};
constexpr Case cases[] = {{"S1_push", 40, 0}, {"S2_moebius", 45, 0}, {"S5_roll", 72, 9.81}, {"S8_dcone", 44, 0}};

struct Run {
  std::vector<Points3> frames;  // grid points
  double triangles = 0, elastic_ms = 0, geometry_ms = 0, worst_ms = 0, c_m = 0, edge = 0, iterations = 0;
  int singular = 0;
};

Points3 sample(const Sheet& sheet, const Pattern& pattern) {
  const Locator locator(sheet.pattern, sheet.triangles);
  const Vector2d size = extent(pattern);
  Points3 points(grid * grid, 3);
  for (int i = 0; i < grid; ++i)
    for (int j = 0; j < grid; ++j)
      points.row(i * grid + j) = interpolate(locator.locate({size.x() * i / (grid - 1), size.y() * j / (grid - 1)}), sheet.triangles, sheet.x);
  return points;
}

Run run(const Shot& shot, const Method& method, const Case& c, double fps) {
  AnimateOptions options;
  options.fps = fps;
  options.last_frame = c.last_frame;
  options.elastic.gravity = c.gravity;
  Run r;
  animate(shot, method, options, [&](const AnimatedFrame& f) {
    r.frames.push_back(sample(*f.sheet, shot.pattern));
    const LengthDistortion d = length_distortion(*f.sheet);
    r.triangles += f.sheet->triangles.rows();
    r.elastic_ms += f.elastic_ms;
    r.geometry_ms += f.geometry_ms;
    r.worst_ms = std::max(r.worst_ms, f.elastic_ms + f.geometry_ms);
    r.c_m += 100 * d.mean;
    r.edge = std::max(r.edge, 100 * d.largest);
    r.iterations += f.newton_iterations;
    r.singular = static_cast<int>(f.sheet->singular.size());
    return true;
  });
  const double n = static_cast<double>(r.frames.size());
  r.triangles /= n, r.elastic_ms /= n, r.geometry_ms /= n, r.c_m /= n, r.iterations /= n;
  return r;
}

double rms_pct(const Run& a, const Run& b, double side) {
  double sum = 0;
  for (std::size_t f = 0; f < a.frames.size(); ++f) sum += std::sqrt((a.frames[f] - b.frames[f]).rowwise().squaredNorm().mean());
  return 100 * sum / side / a.frames.size();
}

void print_row(const char* label, const Run& r, double rms) {
  std::printf("  %-12s %6.0f %8.2f + %.2f (%6.1f) %6.1f it  c_m %.4f  edge %.3f  singular %2d  rms %.3f %%\n", label, r.triangles,
              r.elastic_ms, r.geometry_ms, r.worst_ms, r.iterations, r.c_m, r.edge, r.singular, rms);
  std::fflush(stdout);
}

void compare(const Case& c, int reference_triangles) {
  const Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + c.name + ".glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  const double side = longer_side(shot.pattern);
  std::printf("%s, frames 1-%d\n  %-12s %6s %8s\n", c.name, c.last_frame, "", "tri", "elastic + geometry ms (worst)");
  const Run reference = run(shot, fem(reference_triangles), c, scene.fps);
  print_row("fem", reference, 0);
  const Run coarse_fem = run(shot, fem(1700), c, scene.fps);
  print_row("fem", coarse_fem, rms_pct(coarse_fem, reference, side));
  double sum = 0, least = 1e9, most = 0;
  for (const int base : {100, 120, 140}) {
    const Run h = run(shot, hybrid(shot.pattern, shot.paper, base, {}, 0, 0), c, scene.fps);
    const double rms = rms_pct(h, reference, side);
    print_row(("hybrid " + std::to_string(base)).c_str(), h, rms);
    sum += rms, least = std::min(least, rms), most = std::max(most, rms);
  }
  std::printf("  hybrid rms %.3f [%.3f, %.3f] %%\n", sum / 3, least, most);
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  const int reference = argc > 1 ? std::atoi(argv[1]) : 6000;
  for (const auto& c : paperbake::cases) {
    bool wanted = argc < 3;
    for (int i = 2; i < argc; ++i) wanted |= std::string(c.name).rfind(argv[i], 0) == 0;
    if (wanted) paperbake::compare(c, reference);
  }
}
