#include "baker/bake/bend_watch.h"

#include "core/geometry/mesh_coarseness.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// A sheet of small triangles that is folded along its middle, and seen for ten frames.
class BendWatchTest : public testing::Test {
 protected:
  /// Shows frames with a fold of this angle. [rad]
  void show(int frames, double fold) {
    Sheet sheet = flat;
    for (int v = 0; v < sheet.x.rows(); ++v) {
      const double beyond = std::max(0.0, flat.pattern(v, 0) - 0.5 * side);
      sheet.x.row(v) << flat.pattern(v, 0) - beyond * (1 - std::cos(fold)), flat.pattern(v, 1),
          beyond * std::sin(fold);
    }
    AnimatedFrame frame;
    frame.sheet = &sheet;
    frame.statistics = statistics;
    for (int k = 0; k < frames; ++k) watch.look(frame, pattern);
  }

  static constexpr double side = 0.1;  // [m]
  Sheet flat = test::hex_sheet(side, side, 40);
  const Pattern pattern = [] {
    Pattern square;
    square.outline = {{0, 0}, {side, 0}, {side, side}, {0, side}};
    return square;
  }();
  FrameStatistics statistics;
  BendWatch watch;
};

TEST_F(BendWatchTest, AnEdgeThatIsDrawnAsACreaseIsTooSharpForSmoothPaper) {
  show(9, 0);
  EXPECT_FALSE(watch.is_coarse());
  show(2, 1);
  EXPECT_TRUE(watch.is_coarse());
}

TEST_F(BendWatchTest, OnlyAWholeCreaseMakesAFinerMeshDoubted) {
  show(1, 0);
  show(9, 0.75);
  EXPECT_TRUE(watch.is_coarse());
  EXPECT_FALSE(watch.is_creased());
  show(9, 2);
  EXPECT_TRUE(watch.is_creased());
}

TEST_F(BendWatchTest, ATenthOfTheFramesMayBeSharp) {
  show(9, 0);
  show(1, 2);
  EXPECT_FALSE(watch.is_coarse());
  EXPECT_FALSE(watch.is_creased());
}

TEST_F(BendWatchTest, WhatWasModelledSoMayBeSharp) {
  statistics.on_colliders = 3;
  show(1, 1);
  statistics.on_colliders = 0;
  show(9, 1);
  EXPECT_FALSE(watch.is_coarse());
  EXPECT_FALSE(watch.is_creased());
}

TEST_F(BendWatchTest, AlongACreaseOfTheSceneItMayBeSharp) {
  flat.prescribed_creases = {PrescribedCrease{}};
  show(1, 0);
  show(9, 1);
  EXPECT_FALSE(watch.is_coarse());
  EXPECT_FALSE(watch.is_creased());
}

TEST_F(BendWatchTest, AFoldThatIsFoundInTheEndDoesNotExcuseWhatWasBefore) {
  show(9, 0);
  show(2, 1);
  flat.prescribed_creases = {PrescribedCrease{}};
  show(9, 1);
  EXPECT_TRUE(watch.is_coarse());
}

TEST_F(BendWatchTest, FromWhereItIsFoundAFoldMayBeSharp) {
  show(9, 0);
  flat.prescribed_creases = {PrescribedCrease{}};
  show(9, 1);
  EXPECT_FALSE(watch.is_coarse());
}

TEST_F(BendWatchTest, WhatTouchesPaperMayCreaseItAndInertiaMayBlurIt) {
  FrameStatistics on_collider, on_other_sheet, with_inertia;
  on_collider.on_colliders = 3;
  on_other_sheet.touching_others = 3;
  with_inertia.inertia = true;
  for (const FrameStatistics& excused : {on_collider, on_other_sheet, with_inertia}) {
    watch = {};
    statistics = {};
    show(1, 0);
    statistics = excused;
    show(9, 1);
    EXPECT_FALSE(watch.is_coarse());
    EXPECT_FALSE(watch.is_creased());
  }
}

TEST_F(BendWatchTest, AMeshThatPutsTheSheetOffIsCoarse) {
  show(1, 0);
  statistics.mesh_error = 0.006;
  statistics.converged = false;
  show(9, 0);
  EXPECT_FALSE(watch.is_coarse()) << "of a frame that did not settle nothing is known";
  statistics.converged = true;
  show(9, 0);
  EXPECT_TRUE(watch.is_coarse());
}

TEST(BendWatch, ARibbonDoesNotHideInItsLengthHowAngularItIs) {
  const double length = 0.4, width = 0.02;
  Sheet sheet = test::hex_sheet(length, width, 16);
  Pattern pattern;
  pattern.outline = {{0, 0}, {length, 0}, {length, width}, {0, width}};
  AnimatedFrame frame;
  frame.sheet = &sheet;
  BendWatch watch;
  watch.look(frame, pattern);
  const double radius = 0.05;  // [m]
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double u = sheet.pattern(v, 0) / radius;
    sheet.x.row(v) << radius * std::sin(u), sheet.pattern(v, 1), radius * (1 - std::cos(u));
  }
  ASSERT_LT(sharpest_fold(sheet), 0.4) << "nothing is drawn as a crease";
  ASSERT_LT(rms_sagitta(sheet), 0.005 * length);
  for (int k = 0; k < 9; ++k) watch.look(frame, pattern);
  EXPECT_TRUE(watch.is_coarse());
}

}  // namespace
}  // namespace paperbake
