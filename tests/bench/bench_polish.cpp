// Two tables: the estimated error of a frame against its true error, and what polishing costs and
// leaves.
//
//   build/paperbake_bench_polish [REFERENCE_TRIANGLES [SCENE...]]
//
// Every 12th frame of hybrid (base 120) on elastic paper, as it is rendered (the curved surface
// that its mesh stands for). RMS over 41 x 41 points of the pattern, in % of the longer side:
//   true      distance from a full run of fem with REFERENCE_TRIANGLES (6,000)
//   estimate  distance from the nearest minimum of fem with 2,400, as in `verify --estimate`
//   polished  what is left of the first after polishing with as many triangles as the reference has
// CPU time of one thread [ms]. spread: one estimate every 12 frames, divided over these frames.
// BENCH_CACHE=DIR in the environment keeps the runs of fem there.

#include "core/animation/cpu_clock.h"
#include "core/animation/polisher.h"
#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/methods/hybrid.h"
#include "core/render/curved_surface.h"
#include "tests/bench/against_fem.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace paperbake::bench {
namespace {

constexpr int every = 12, estimating = 2400;  // [frames], [triangles]

std::vector<HeldHandle> held_in(const AnimatedFrame& frame) {
  std::vector<HeldHandle> held;
  for (std::size_t h = 0; h < frame.handles.size(); ++h)
    if (frame.handles[h].state != HandleFrame::free)
      held.push_back({static_cast<int>(h), frame.handles[h].at});
  return held;
}

struct Timed {
  Polished polished;
  double ms;
};
Timed timed(Polisher& polish, const Sheet& sheet, const std::vector<HeldHandle>& held) {
  const double begun = cpu_ms();
  Polished polished = polish(sheet, held);
  return {std::move(polished), cpu_ms() - begun};
}

/// The curved surface that a coarse sheet stands for, on a fine mesh.
Sheet curved(const Sheet& rough, Sheet fine) {
  const PointLocator locator(rough.pattern, rough.triangles);
  const CurvedSurface surface = curve(rough);
  for (int v = 0; v < fine.x.rows(); ++v)
    fine.x.row(v) = surface.at(locator.locate(fine.pattern.row(v)));
  return fine;
}

struct Counts {
  int frames = 0, within = 0;
};

void compare(const Case& c, int triangles, Counts& all) {
  const auto [shot, fps] = shot_of(c);
  const double side = longer_side(shot.pattern);
  const Run reference = run_fem(shot, triangles, c, fps);
  std::printf("%s, frames 1-%d; fem %d: %.0f ms a frame\n", c.name, c.last_frame, triangles,
              reference.elastic_ms);
  AnimateOptions options;
  options.fps = fps;
  options.last_frame = c.last_frame;
  options.elastic.forces.gravity = c.gravity;
  Polisher estimator(shot, options.elastic, estimating), polisher(shot, options.elastic, triangles);
  const PatternSamples samples(shot.pattern);
  const auto pct = [&](const Points3& a, const Points3& b) {
    return 100 / side * rms_distance(a, b);
  };
  double estimates_ms = 0;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
          [&](const AnimatedFrame& f) {
            if (f.frame % every != 0) return true;
            const std::vector<HeldHandle> held = held_in(f);
            const Timed estimate = timed(estimator, *f.sheet, held),
                        fine = timed(polisher, *f.sheet, held);
            const Points3& truth = reference.frames[f.frame - 1];
            const double error = pct(samples(curved(*f.sheet, estimate.polished.sheet)), truth),
                         estimated = 100 / side * estimate.polished.moved;
            const bool within = std::abs(estimated / error - 1) <= 0.3;
            ++all.frames;
            all.within += within;
            estimates_ms += estimate.ms;
            std::printf(
                "  f%2d  estimate %.3f  true %.3f  ratio %.2f%s  %3.0f ms, %2d it;  polished %.3f  "
                "%4.0f ms, %2d it%s\n",
                f.frame, estimated, error, estimated / error, within ? " " : "*", estimate.ms,
                estimate.polished.iterations, pct(samples(fine.polished.sheet), truth), fine.ms,
                fine.polished.iterations, fine.polished.converged ? "" : ", not at rest");
            std::fflush(stdout);
            return true;
          });
  std::printf("  spread: %.1f ms\n", estimates_ms / c.last_frame);
}

}  // namespace
}  // namespace paperbake::bench

int main(int argc, char** argv) {
  paperbake::bench::Counts all;
  for (const auto& c : paperbake::bench::cases_named({argv + std::min(argc, 2), argv + argc}))
    paperbake::bench::compare(c, argc > 1 ? std::atoi(argv[1]) : 6000, all);
  std::printf("estimates within 30 %%: %d of %d\n", all.within, all.frames);
}
