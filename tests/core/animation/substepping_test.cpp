#include "core/animation/animate.h"
#include "core/geometry/rigid_motion.h"
#include "core/methods/fem.h"
#include "tests/core/animation/together_shots.h"
#include "tests/core/collider_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace paperbake {
namespace {

constexpr int frames = 8;

/// The way of a hand: it turns, and moves by 20 mm a frame.
Eigen::Isometry3d carried(int frame) {
  return Eigen::Translation3d(0.02 * frame, 0, 0.01 * frame) *
         Eigen::AngleAxisd(0.1 * frame, Vector3d(0.2, 1, 0.3).normalized());
}

/// A sheet that three handles hold on a tray, half a millimetre above it.
Shot on_a_tray(bool moves_tray, bool moves_handles) {
  Shot shot = test::placed(0.1, 0.1, {-0.05, -0.05, 0}, Vector3d(1, 0, 0), Vector3d(0, 1, 0));
  for (const Vector2d& p : {Vector2d(0.02, 0.02), Vector2d(0.08, 0.02), Vector2d(0.05, 0.08)}) {
    const Vector3d at(p.x() - 0.05, p.y() - 0.05, 0);
    test::hold(
        shot, p, frames,
        [&](int f) { return Vector3d(moves_handles ? carried(f) * at - at : Vector3d(0, 0, 0)); },
        {-0.05, -0.05, 0}, Vector3d(1, 0, 0), Vector3d(0, 1, 0));
  }
  ColliderMesh tray{"tray", Points3(4, 3), Triangles(2, 3), {}};
  tray.x << -0.03, -0.03, -0.0005, 0.03, -0.03, -0.0005, 0.03, 0.03, -0.0005, -0.03, 0.03, -0.0005;
  tray.triangles << 0, 1, 2, 0, 2, 3;
  for (int f = 0; f < frames; ++f) {
    tray.frames.own().push_back(tray.x);
    if (moves_tray)
      for (int v = 0; v < 4; ++v)
        tray.frames.own().back().row(v) = carried(f) * Vector3d(tray.x.row(v).transpose());
  }
  shot.colliders = std::make_shared<const Colliders>(Colliders{Collider(tray)});
  return shot;
}

struct Result {
  int most_substeps = 0;
  Points3 x;  // [m] at the end
};

Result simulated(const Shot& shot) {
  AnimateOptions options;
  options.last_frame = frames;
  Result result;
  animate(shot, fem(60), options, [&](const AnimatedFrame& frame) {
    result.most_substeps = std::max(result.most_substeps, frame.statistics.substeps);
    result.x = frame.sheet->x;
    return true;
  });
  return result;
}

TEST(SubsteppingTest, AFrameIsNotDividedForAColliderThatMovesWithTheHandlesOfTheSheet) {
  Shot without_tray = on_a_tray(false, true);
  without_tray.colliders.reset();
  const int by_handles = simulated(without_tray).most_substeps;
  EXPECT_GT(simulated(on_a_tray(true, false)).most_substeps, by_handles);
  const Result still = simulated(on_a_tray(false, false)), moved = simulated(on_a_tray(true, true));
  EXPECT_EQ(moved.most_substeps, by_handles);
  // the small mass of a quasi-static step holds the sheet back a little
  constexpr double lag = 2e-4;  // [m]
  const RigidMotion back = nearest_rigid_motion(moved.x, still.x);
  for (Eigen::Index v = 0; v < still.x.rows(); ++v)
    EXPECT_LT((back(moved.x.row(v)) - still.x.row(v).transpose()).norm(), lag);
}

/// A sheet that is held at its corners, and a block that goes through it in the third frame.
/// speed  [m/s]
Shot through_a_held_sheet(double speed) {
  constexpr double start = -0.041, fps = 24;
  Shot shot = test::placed(0.1, 0.1, {-0.05, -0.05, 0}, Vector3d(1, 0, 0), Vector3d(0, 1, 0));
  for (const Vector2d& p :
       {Vector2d(0, 0), Vector2d(0.1, 0), Vector2d(0, 0.1), Vector2d(0.1, 0.1)}) {
    test::hold(
        shot, p, frames, [](int) { return Vector3d(0, 0, 0); }, {-0.05, -0.05, 0},
        Vector3d(1, 0, 0), Vector3d(0, 1, 0));
  }
  ColliderMesh block = test::box({-0.02, -0.015, start}, {0.02, 0.015, start + 0.04});
  for (int f = 0; f < frames; ++f) {
    block.frames.own().push_back(block.x);
    block.frames.own().back().col(2).array() += f < 2 ? 0 : speed / fps;
  }
  shot.colliders = test::all({block});
  return shot;
}

TEST(SubsteppingTest, AColliderThatIsVeryFastIsFollowedInStepsAsShortAsThatTakes) {
  AnimateOptions options;
  options.last_frame = 4;
  for (const double speed : {8.0, 20.0, 40.0}) {
    int last = 0;
    animate(through_a_held_sheet(speed), fem(150), options, [&](const AnimatedFrame& frame) {
      last = frame.frame;
      EXPECT_EQ(frame.note.find("stays as it was"), std::string::npos) << frame.note;
      EXPECT_LT(frame.statistics.stretch_max, 0.03) << speed;
      if (frame.frame < 3) return true;
      EXPECT_NE(frame.note.find("give way"), std::string::npos) << frame.note;
      EXPECT_GT(frame.sheet->x.col(2).maxCoeff(), 0.02) << "the block takes it along";
      return true;
    });
    EXPECT_EQ(last, 4);
  }
}

}  // namespace
}  // namespace paperbake
