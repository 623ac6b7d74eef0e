#include "core/animation/motion_measures.h"

#include "core/animation/animate.h"
#include "core/methods/hybrid.h"
#include "tests/core/collider_meshes.h"
#include "tests/core/test_shots.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace paperbake {
namespace {

const std::vector<Vector2d> fingers{{0.005, 0.015}, {0.005, 0.04}, {0.02, 0.0275}};

/// Constraints of vertices 0, 1, ... that were at these points and go where a motion takes them.
template <class Motion>
PositionConstraints held(const std::vector<Vector3d>& points, const Motion& motion) {
  PositionConstraints held;
  for (std::size_t k = 0; k < points.size(); ++k)
    held.push_back({static_cast<int>(k), motion(points[k])});
  return held;
}

Eigen::Isometry3d turned(double angle) {
  return Eigen::Translation3d(0.01, 0.02, 0.03) *
         Eigen::AngleAxisd(angle, Vector3d(1, 2, -1).normalized());
}

TEST(MotionMeasuresTest, HandlesThatMoveAsOneBodyDoNotMoveRelativeToEachOther) {
  const auto stay = [](const Vector3d& p) { return p; };
  const auto turn = [](const Vector3d& p) { return Vector3d(turned(0.7) * p); };
  for (const std::vector<Vector3d>& points : std::vector<std::vector<Vector3d>>{
           {{0.1, 0, 0}},
           {{0.1, 0, 0}, {0, 0.1, 0}},
           {{0, 0, 0}, {0.1, 0, 0}, {0.2, 0, 0}},
           {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.1, 0.1, 0.05}}}) {
    EXPECT_EQ(relative_handle_motion({}, held(points, turn), held(points, stay)), 0)
        << points.size();
    if (points.size() < 2) continue;
    PositionConstraints other = held(points, turn);
    other.back().target += Vector3d(0, 0, 0.01) + 0.1 * (other.back().target - other[0].target);
    EXPECT_GT(relative_handle_motion({}, other, held(points, stay)), 0.005) << points.size();
  }
}

/// A card that three fingers flick round by 12 degrees a frame, with a table far below it.
TEST(MotionMeasuresTest, FingersThatFlickACardDoNotBendIt) {
  constexpr int frames = 9;
  Shot shot = test::blank_shot(test::rectangle(0.085, 0.055));
  for (const Vector2d& p : fingers) {
    Handle handle = test::bare_handle("handle." + std::to_string(shot.handles.size()), p, frames);
    for (int f = 0; f < frames; ++f)
      handle.keyed.row(f) = Eigen::AngleAxisd(f * 12 * M_PI / 180, Vector3d::UnitZ()) *
                                Vector3d(p.x() + 0.03, p.y(), 0) -
                            Vector3d(0.03, 0, 0);
    shot.handles.push_back(handle);
  }
  ColliderMesh table{"table", Points3(4, 3), Triangles(2, 3), {}};
  table.x << -1, -1, -0.1, 1, -1, -0.1, 1, 1, -0.1, -1, 1, -0.1;
  table.triangles << 0, 1, 2, 0, 2, 3;
  shot.colliders = std::make_shared<const Colliders>(Colliders{Collider(table)});
  AnimateOptions options;
  options.last_frame = frames;
  options.plasticity = Plasticity::on;
  double most = 0;  // [m] out of its plane
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
          [&](const AnimatedFrame& frame) {
            most = std::max(most, frame.sheet->x.col(2).cwiseAbs().maxCoeff());
            return true;
          });
  EXPECT_LT(most, 2e-5);
}

/// What squeezes is what deforms: a cage that shrinks does, one that goes elsewhere as it is does
/// not.
TEST(MotionMeasuresTest, ASheetIsSqueezedByCollidersThatMoveRelativeToEachOther) {
  const Colliders cage{Collider(test::box({-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06}, true))};
  const ColliderShapes from = shapes_at(cage, 0);
  Points3 x(4, 3);  // on two opposite sides, within the reach of the barrier
  x << -0.0598, 0, 0, -0.0598, 0.01, 0, 0.0598, 0, 0, 0.0598, 0.01, 0;
  const auto moved = [&](const Points3& to) -> ColliderShapes {
    return {std::make_shared<const Collider>(*from[0], to)};
  };
  const Points3& now = from[0]->mesh().x;
  EXPECT_EQ(squeeze(x, {from, from}), 0);
  EXPECT_LT(squeeze(x, {from, moved(now.rowwise() + Eigen::RowVector3d(0.01, 0, 0))}), 1e-9);
  EXPECT_NEAR(squeeze(x, {from, moved(0.9 * now)}), 0.006, 3e-4);
}

}  // namespace
}  // namespace paperbake
