// Hybrid against the finest fem on the sample scenes: a table anyone can print.
//
//   build/paperbake_bench_hybrid [REFERENCE_TRIANGLES [SCENE...]]
//
// One thread, CPU time. All distances over a 41 x 41 grid of the pattern, in % of the longer side.
//   rms    distance to fem's sheet, mean over the frames; hybrid with three base densities: mean [least, most]
//   nrm    angle between the normals as they are shaded, mean over grid and frames [deg]
//   jit    rms of x_f - 2 x_{f-1} + x_{f-2}: median / 90 % quantile over the frames
//   ruled  ruling remeshes accepted - rejected, and the largest rise of the potential at an accepted one
// Environment: BENCH_BASES="60 75 90" base densities; BENCH_CACHE=DIR keeps the runs of fem there for the next time;
// BENCH_SET="facet_turn=0.2 flip_gain=0.5" options; facet_turn=0: the robust mesh alone.

#include "core/animate.h"
#include "core/measure.h"
#include "core/pattern_samples.h"
#include "formats/scene_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
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

/// Means over the frames, but for worst_ms, edge and rise: the worst.
struct Numbers {
  double triangles = 0, elastic_ms = 0, geometry_ms = 0, worst_ms = 0, c_m = 0, edge = 0, iterations = 0, rise = 0;
  int singular = 0, accepted = 0, rejected = 0;
};
struct Run : Numbers {
  std::vector<Points3> frames, normals;  // of the grid points
};

Run run(const Shot& shot, const Method& method, const Case& c, double fps) {
  AnimateOptions options;
  options.fps = fps;
  options.last_frame = c.last_frame;
  options.elastic.gravity = c.gravity;
  const PatternSamples samples(shot.pattern, grid);
  Run r;
  animate(shot, method, options, [&](const AnimatedFrame& f) {
    PatternSamples::Sampled sampled = samples(*f.sheet);
    r.frames.push_back(std::move(sampled.x)), r.normals.push_back(std::move(sampled.normals));
    r.accepted += f.remesh == AnimatedFrame::accepted;
    r.rejected += f.remesh == AnimatedFrame::rejected;
    if (f.remesh == AnimatedFrame::accepted) r.rise = std::max(r.rise, 100 * f.remesh_rise);
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
  for (std::size_t f = 0; f < a.frames.size(); ++f) sum += rms_distance(a.frames[f], b.frames[f]);
  return 100 * sum / side / a.frames.size();
}

double normals_deg(const Run& a, const Run& b) {
  double sum = 0;
  for (std::size_t f = 0; f < a.normals.size(); ++f)
    sum += a.normals[f].cwiseProduct(b.normals[f]).rowwise().sum().array().min(1).max(-1).acos().mean();
  return sum / a.normals.size() * 180 / M_PI;
}

std::vector<double> jitter_pct(const Run& r, double side) {
  std::vector<double> all;
  for (std::size_t f = 2; f < r.frames.size(); ++f)
    all.push_back(100 / side * std::sqrt((r.frames[f] - 2 * r.frames[f - 1] + r.frames[f - 2]).rowwise().squaredNorm().mean()));
  std::sort(all.begin(), all.end());
  return all;
}

void print_row(const std::string& label, const Run& r, const Run& reference, double side) {
  const std::vector<double> jitter = jitter_pct(r, side);
  std::printf("  %-10s %5.0f %7.2f + %.2f (%6.1f) %5.1f it  c_m %.4f edge %.3f sing %2d  ruled %d-%d %+.1f %%  jit %.3f/%.2f  nrm %.2f  rms %.3f %%\n",
              label.c_str(), r.triangles, r.elastic_ms, r.geometry_ms, r.worst_ms, r.iterations, r.c_m, r.edge, r.singular, r.accepted,
              r.rejected, r.rise, jitter[jitter.size() / 2], jitter[jitter.size() * 9 / 10], normals_deg(r, reference), rms_pct(r, reference, side));
  std::fflush(stdout);
}

/// A run of fem, from the cache when there is one.
Run run_fem(const Shot& shot, int triangles, const Case& c, double fps) {
  const char* folder = std::getenv("BENCH_CACHE");
  const std::string path = std::string(folder ? folder : "") + "/" + c.name + "_" + std::to_string(triangles) + ".run";
  const Eigen::Index size = 3 * grid * grid;
  Run r;
  if (std::ifstream file(path, std::ios::binary); folder && file) {
    file.read(reinterpret_cast<char*>(static_cast<Numbers*>(&r)), sizeof(Numbers));
    r.frames.assign(c.last_frame, Points3(grid * grid, 3));
    r.normals = r.frames;
    for (auto* all : {&r.frames, &r.normals})
      for (Points3& p : *all) file.read(reinterpret_cast<char*>(p.data()), size * sizeof(double));
    if (file) return r;
  }
  r = run(shot, fem(triangles), c, fps);
  if (!folder) return r;
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(static_cast<const Numbers*>(&r)), sizeof(Numbers));
  for (const auto* all : {&r.frames, &r.normals})
    for (const Points3& p : *all) file.write(reinterpret_cast<const char*>(p.data()), size * sizeof(double));
  return r;
}

CrumpleOptions options_set() {
  CrumpleOptions o;
  RulingOptions& r = o.rulings;
  const std::map<std::string, double*> by_name{{"flip_gain", &o.flip_gain},           {"conflict_turn", &o.conflict_turn}, {"facet_turn", &r.facet_turn},
                                               {"curved_above", &r.curved_above}, {"coherent", &r.coherent},           {"window", &r.window},
                                               {"pull", &r.pull},                 {"across_most", &r.across_most},     {"across_least", &r.across_least},
                                               {"along_most", &r.along_most},     {"merge", &r.merge},                 {"guard", &r.guard},
                                               {"stale_fold", &r.stale_fold},     {"most_share", &r.most_share}};
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
  const Scene scene = read_scene(std::string(PAPERBAKE_SAMPLES "/") + c.name + ".glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  const double side = longer_side(shot.pattern);
  std::printf("%s, frames 1-%d\n  %-10s %5s %7s\n", c.name, c.last_frame, "", "tri", "elastic + geometry ms (worst)");
  const Run reference = run_fem(shot, reference_triangles, c, scene.fps);
  print_row("fem", reference, reference, side);
  print_row("fem", run_fem(shot, 1700, c, scene.fps), reference, side);
  const CrumpleOptions options = options_set();
  Numbers mean;
  double sum = 0, normals = 0, least = 1e9, most = 0;
  for (const int base : bases()) {
    const Run h = run(shot, hybrid(shot.pattern, shot.paper, base, options, 0, 0), c, scene.fps);
    const double rms = rms_pct(h, reference, side);
    print_row("hybrid " + std::to_string(base), h, reference, side);
    if (std::getenv("BENCH_FRAMES"))
      for (std::size_t f = 0; f < h.frames.size(); ++f)
        std::printf("    frame %2zu rms %.3f %%\n", f + 1, 100 / side * rms_distance(h.frames[f], reference.frames[f]));
    sum += rms, least = std::min(least, rms), most = std::max(most, rms);
    normals += normals_deg(h, reference), mean.triangles += h.triangles, mean.elastic_ms += h.elastic_ms, mean.geometry_ms += h.geometry_ms;
  }
  const double n = static_cast<double>(bases().size());
  std::printf("  hybrid: %.0f tri, %.2f + %.2f ms, nrm %.2f deg, rms %.3f [%.3f, %.3f] %%\n", mean.triangles / n, mean.elastic_ms / n,
              mean.geometry_ms / n, normals / n, sum / n, least, most);
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
