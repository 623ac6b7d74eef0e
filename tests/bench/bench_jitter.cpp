// Table: how far noise in the keys moves a sheet that bends smoothly.
//
//   build/paperbake_bench_jitter [RUNS [SCENE...]]
//
// Each scene is simulated by hybrid as it is, and RUNS times (default 10) with keys that are moved
// by up to a micrometre along each axis. Elastic paper. RMS over 41 x 41 points of the pattern,
// mean over the frames, in % of the longer side:
//   apart        from the run without noise: mean and largest of the runs
//   worst frame  the largest of any frame of any run
//   births       singular points of all runs: least and largest number
//   from fem     from fem of 6,000 triangles: the run without noise; mean, least, largest with it
// Environment: BENCH_CACHE=FOLDER keeps the runs of fem

#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/geometry/random.h"
#include "core/methods/hybrid.h"
#include "tests/bench/against_fem.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace paperbake::bench {
namespace {

/// The shot with noise of up to 1e-6 m in every key that differs from the one before. What rests
/// keeps its place.
Shot jittered(Shot shot, unsigned seed) {
  constexpr double noise = 1e-6;  // [m]
  std::uint64_t draw = 0;
  for (Handle& handle : shot.handles) {
    const Points3 keyed = handle.keyed;
    Vector3d moved = Vector3d::Zero();
    for (int row = 1; row < keyed.rows(); ++row) {
      if (keyed.row(row) != keyed.row(row - 1))
        for (double& axis : moved) axis = noise * uniform(seed, draw++);
      handle.keyed.row(row) += moved.transpose();
    }
  }
  return shot;
}

struct Spread {
  double sum = 0, least = 1e300, most = 0;
  int count = 0;
  void add(double value) {
    sum += value;
    least = std::min(least, value);
    most = std::max(most, value);
    ++count;
  }
  double mean() const { return sum / count; }
};

void print_row(const Case& c, int runs) {
  const auto [shot, fps] = shot_of(c);
  const double side = longer_side(shot.pattern);
  const auto simulate = [&](const Shot& s) {
    return run(s, hybrid(s.pattern, s.paper, 120, {}, 0, 0), c, fps);
  };
  const Run fine = run_fem(shot, 6000, c, fps), still = simulate(shot);
  Spread apart, frames, births, from_fem;
  births.add(still.singular);
  for (int k = 1; k <= runs; ++k) {
    const Run noisy = simulate(jittered(shot, static_cast<unsigned>(k)));
    apart.add(rms_pct(noisy, still, side));
    births.add(noisy.singular);
    from_fem.add(rms_pct(noisy, fine, side));
    for (std::size_t f = 0; f < still.frames.size(); ++f)
      frames.add(100 / side * rms_distance(noisy.frames[f], still.frames[f]));
  }
  std::printf(
      "%-11s apart %.3f %.3f  worst frame %.2f  births %.0f %.0f  from fem %.3f; %.3f %.3f %.3f\n",
      c.name, apart.mean(), apart.most, frames.most, births.least, births.most,
      rms_pct(still, fine, side), from_fem.mean(), from_fem.least, from_fem.most);
  std::fflush(stdout);
}

}  // namespace
}  // namespace paperbake::bench

int main(int argc, char** argv) {
  using namespace paperbake::bench;
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 10;
  for (const Case& c : cases_named({argv + std::min(argc, 2), argv + argc})) print_row(c, runs);
}
