// How long the parts of a Newton iteration take, a whole loop over frames, and the geometry around
// it. One thread throughout.
//
//   paperbake_bench [--benchmark_filter=REGEX]

#include "core/animation/animate.h"
#include "core/geometry/curvature.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/pattern_mesh.h"
#include "core/methods/fem.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "tests/core/test_shots.h"

#include <benchmark/benchmark.h>

#include <map>
#include <memory>

namespace paperbake {
namespace {

constexpr int last_push = 24;  // frame of S1 at which the sheet has been pushed by 10 mm: an arch

AnimateOptions s1_options() {
  AnimateOptions options;
  options.last_frame = last_push;
  return options;
}

/// The arch of S1 on a mesh of about so many triangles, with everything that one Newton iteration
/// needs.
struct Arch {
  Sheet sheet;
  std::unique_ptr<ElasticEnergy> energy;
  std::unique_ptr<BlockCholesky> matrix;
  Points3 gradient;
  int free = 0;

  explicit Arch(int triangles) {
    const Shot shot = test::s1_push();
    animate(shot, fem(triangles), s1_options(), [&](const AnimatedFrame& frame) {
      sheet = *frame.sheet;
      return true;
    });
    energy = std::make_unique<ElasticEnergy>(shot.paper, sheet.pattern, sheet.triangles);
    std::vector<int> block_of(sheet.x.rows());
    for (int v = 0; v < sheet.x.rows(); ++v) block_of[v] = held(v) ? -1 : free++;
    std::vector<std::pair<int, int>> coupled;
    for (const auto& [i, j] : energy->coupled_vertices())
      if (block_of[i] >= 0 && block_of[j] >= 0) coupled.emplace_back(block_of[i], block_of[j]);
    matrix = std::make_unique<BlockCholesky>(free, std::move(coupled));
    energy->bind(*matrix, block_of);
    assemble();
  }

  void assemble() {
    matrix->set_zero();
    energy->hessian(sheet.x, HessianForm::exact, gradient, *matrix);
    matrix->shift_diagonal(1e-3);  // [N/m] the small inertia of a quasi-static step
  }

  /// The handles of S1 are a centimetre apart on two borders.
  bool held(int v) const {
    const Vector2d p = sheet.pattern.row(v);
    const bool border = p.x() < 1e-9 || p.x() > 0.1 - 1e-9;
    return border && std::abs(p.y() - 0.01 * std::round(100 * p.y())) < 1e-9;
  }
};

Arch& arch(const benchmark::State& state) {
  static std::map<long, std::unique_ptr<Arch>> made;
  auto& arch = made[state.range(0)];
  if (!arch) arch = std::make_unique<Arch>(static_cast<int>(state.range(0)));
  return *arch;
}

void count_triangles(benchmark::State& state, const Sheet& sheet) {
  state.counters["triangles"] = sheet.triangles.rows();
}

void energy(benchmark::State& state) {
  const Arch& a = arch(state);
  for (auto _ : state) benchmark::DoNotOptimize(a.energy->energy(a.sheet.x));
  count_triangles(state, a.sheet);
}

void gradient(benchmark::State& state) {
  Arch& a = arch(state);
  for (auto _ : state) benchmark::DoNotOptimize(a.energy->gradient(a.sheet.x, a.gradient));
  count_triangles(state, a.sheet);
}

void assembly_of_exact_hessian(benchmark::State& state) {
  Arch& a = arch(state);
  for (auto _ : state) a.assemble();
  count_triangles(state, a.sheet);
}

void factorisation(benchmark::State& state) {
  Arch& a = arch(state);
  for (auto _ : state)
    if (!a.matrix->factorise()) return state.SkipWithError("the arch is not stable");
  count_triangles(state, a.sheet);
  state.counters["blocks"] = a.free;
}

void solve(benchmark::State& state) {
  Arch& a = arch(state);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * a.free, -1, 2);
  if (!a.matrix->factorise()) return state.SkipWithError("the arch is not stable");
  for (auto _ : state) benchmark::DoNotOptimize(a.matrix->solve(b).data());
  count_triangles(state, a.sheet);
}

/// Frames 1-24 of S1. The times per frame are from the timers of `animate`; the time of the
/// benchmark is that of the whole loop.
void frames_of_s1(benchmark::State& state) {
  const Shot shot = test::s1_push();
  double elastic_ms = 0, geometry_ms = 0, iterations = 0, frames = 0;
  Sheet last;
  for (auto _ : state)
    animate(shot, fem(static_cast<int>(state.range(0))), s1_options(),
            [&](const AnimatedFrame& frame) {
              elastic_ms += frame.statistics.elastic_ms;
              geometry_ms += frame.statistics.geometry_ms;
              iterations += frame.statistics.newton_iterations;
              frames += 1;
              if (frame.frame == last_push) last = *frame.sheet;
              return true;
            });
  state.counters["elastic_ms/frame"] = elastic_ms / frames;
  state.counters["geometry_ms/frame"] = geometry_ms / frames;
  state.counters["iterations/frame"] = iterations / frames;
  count_triangles(state, last);
}

void pattern_mesh(benchmark::State& state) {
  const Shot shot = test::s1_push();
  std::vector<Vector2d> points;
  for (const Handle& handle : shot.handles) points.push_back(handle.pattern);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        mesh_pattern_with(shot.pattern, static_cast<int>(state.range(0)), points).triangles.data());
}

void curvature_of_vertices(benchmark::State& state) {
  const Arch& a = arch(state);
  for (auto _ : state) benchmark::DoNotOptimize(vertex_curvature(a.sheet).data());
  count_triangles(state, a.sheet);
}

void crossings_of_triangles(benchmark::State& state) {
  const Arch& a = arch(state);
  for (auto _ : state) benchmark::DoNotOptimize(crossings(a.sheet));
  count_triangles(state, a.sheet);
}

void sizes(benchmark::internal::Benchmark* b) {
  for (const long triangles : {150, 600, 1700, 6000}) b->Arg(triangles);
}

BENCHMARK(energy)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(gradient)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(assembly_of_exact_hessian)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(factorisation)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(solve)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(frames_of_s1)->Apply(sizes)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(pattern_mesh)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(curvature_of_vertices)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(crossings_of_triangles)->Apply(sizes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  benchmark::AddCustomContext("threads", "1, the BLAS included");
  benchmark::AddCustomContext("scene", "S1: a sheet of 10 cm, arched by 10 mm in frames 1-24");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
