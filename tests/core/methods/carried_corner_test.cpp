#include "core/animation/animate.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// The corner hooks before it rolls. On meshes too coarse for the hook the paper would break there,
/// as many as eight times; whether it does, depends on the start mesh (docs/limits.md).
TEST(CarriedCornerTest, ASheetCarriedByItsCornerRollsAndDoesNotBreak) {
  const Scene scene = read_scene(PAPERBAKE_SAMPLES "/S5_roll.glb");
  const SceneSheet& s = scene.sheets.front();
  Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  shot.colliders = facing_colliders(scene.colliders, s.start.x, s.handles);
  ASSERT_NE(shot.colliders, nullptr);
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = 72;
  options.plasticity = Plasticity::on;
  options.elastic.forces.gravity = 9.81;
  for (const int base : {120}) {
    double energy = 0;
    animate(shot, hybrid(shot.pattern, shot.paper, base, {}, 0, 0), options,
            [&](const AnimatedFrame& frame) {
              EXPECT_EQ(frame.statistics.new_singular, 0) << base << " " << frame.frame;
              EXPECT_LT(frame.statistics.inside_colliders, 1e-4) << base << " " << frame.frame;
              for (const HandleFrame& handle : frame.handles)
                EXPECT_NE(handle.state, HandleFrame::jammed) << base << " " << frame.frame;
              energy = frame.statistics.energy;
              return true;
            });
    // fem of 6,000 triangles stores 5.03 mJ and does not yield; a locked fold stored 12 mJ
    EXPECT_NEAR(energy / 5.03e-3, 1, 0.35) << base;
  }
}

}  // namespace
}  // namespace paperbake
