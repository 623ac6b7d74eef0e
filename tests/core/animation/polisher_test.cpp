#include "core/animation/polisher.h"
#include "core/animation/initial_sheet.h"

#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A frame of a shot as a method simulates it, and what holds the sheet.
struct Taken {
  Sheet sheet;
  std::vector<HeldHandle> held;
  double energy = 0;
};
Taken take(const Shot& shot, const MethodChoice& method, int frame) {
  AnimateOptions options;
  options.last_frame = frame;
  Taken taken;
  animate(shot, method, options, [&](const AnimatedFrame& f) {
    if (f.frame < frame) return true;
    taken.sheet = *f.sheet;
    taken.energy = f.statistics.energy;
    for (std::size_t h = 0; h < f.handles.size(); ++h)
      if (f.handles[h].state != HandleFrame::free)
        taken.held.push_back({static_cast<int>(h), f.handles[h].at});
    return true;
  });
  return taken;
}

TEST(RefineFrameTest, ACoarseFrameEndsWhereAFullRunOfFineFemIs) {
  const Shot shot = test::s1_push();
  const Taken coarse = take(shot, hybrid(shot.pattern, shot.paper, 90, {}, 0, 0), 20),
              fine = take(shot, fem(1000), 20);
  Polisher polish(shot, {}, 1000);
  const Polished polished = polish(coarse.sheet, coarse.held);
  ASSERT_TRUE(polished.converged);
  const PatternSamples samples(shot.pattern);
  const auto rms = [&](const Sheet& a) { return rms_distance(samples(a), samples(fine.sheet)); };
  // 0.05 % of the sheet away from the fine run ...
  EXPECT_GT(rms(coarse.sheet), 5e-5);
  EXPECT_LT(rms(polished.sheet), 0.1 * rms(coarse.sheet));  // ... and this error is gone
  // the distance moved was the error
  EXPECT_NEAR(polished.moved, rms(coarse.sheet), 0.3 * rms(coarse.sheet));
  EXPECT_NEAR(polished.energy, fine.energy, 1e-3 * fine.energy);
  EXPECT_GT(polished.energy_before, polished.energy);
}

TEST(RefineFrameTest, HandlesStayWhereTheyHoldTheSheet) {
  const Shot shot = test::s1_push();
  const Taken coarse = take(shot, hybrid(shot.pattern, shot.paper, 90, {}, 0, 0), 30);
  Polisher polish(shot, {}, 400);
  const Polished polished = polish(coarse.sheet, coarse.held);
  ASSERT_EQ(coarse.held.size(), 23u);
  for (const HeldHandle& h : coarse.held)
    EXPECT_EQ(polished.sheet.x.row(polish.mesh().handle_vertex[h.handle]), h.at.transpose());
}

TEST(RefineFrameTest, AFrameIsTheSameWhicheverFrameWasPolishedBeforeIt) {
  const Shot shot = test::s1_push();
  const MethodChoice method = hybrid(shot.pattern, shot.paper, 90, {}, 0, 0);
  const Taken one = take(shot, method, 20),
              other = take(shot, hybrid(shot.pattern, shot.paper, 90, {}, 0, 0), 10);
  Polisher polish(shot, {}, 400);
  const Points3 first = polish(one.sheet, one.held).sheet.x;
  polish(other.sheet, other.held);
  EXPECT_TRUE(polish(one.sheet, one.held).sheet.x == first);
}

/// Plastic curvature costs no energy: a sheet that springs back to an arch of its own keeps this
/// arch.
TEST(RefineFrameTest, PlasticCurvatureIsPartOfTheMinimum) {
  const Shot shot = test::blank_shot(test::rectangle(0.1, 0.05));
  PlasticGrid memory(shot.pattern);
  Polisher polish(shot, {}, 300);
  const InitialSheet& mesh = polish.mesh();
  const auto cover = memory.cover(mesh.sheet.pattern, mesh.sheet.triangles);
  PlasticMemory gained(static_cast<int>(mesh.sheet.triangles.rows()));
  gained.curvature.col(0).setConstant(10);  // [1/m] along x
  memory.write(cover, gained);
  Sheet arch = mesh.sheet;
  for (int v = 0; v < arch.x.rows(); ++v) {
    const double s = 10 * (arch.pattern(v, 0) - 0.05);
    arch.x.row(v) << 0.05 + std::sin(s) / 10, arch.pattern(v, 1), (std::cos(s) - 1) / 10;
  }
  const Polished kept = polish(arch, {}, &memory), sprung = polish(arch, {});
  EXPECT_LT(kept.moved, 0.003 * 0.1);
  EXPECT_GT(sprung.energy_before, 1e-5);
  EXPECT_LT(kept.energy, 0.02 * sprung.energy_before);
  EXPECT_GT(sprung.moved, 5 * kept.moved);
}

}  // namespace
}  // namespace paperbake
