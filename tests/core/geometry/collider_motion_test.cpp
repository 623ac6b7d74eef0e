#include "core/geometry/collider_motion.h"

#include "tests/core/collider_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

using test::all;
using test::bin;
using test::box;
using test::ground;

TEST(ColliderMotionTest, AFrameGoesOnFromTheShapesOfTheFrameBefore) {
  ColliderMesh moving = box({-0.01, -0.01, 0}, {0.01, 0.01, 0.02});
  for (const double height : {0.0, 0.003, 0.003, 0.004}) {
    moving.frames.own().push_back(moving.x);
    moving.frames.own().back().col(2).array() += height;
  }
  const auto colliders = all({ground(), moving});
  ColliderShapes before = shapes_at(*colliders, 0);
  for (int row = 1; row < 6; ++row) {
    const ColliderMotion motion = motion_to(*colliders, row, before),
                         anew = motion_to(*colliders, row);
    EXPECT_EQ(motion.from, before);
    EXPECT_EQ(motion.to[0], motion.from[0]) << "the ground stands still";
    EXPECT_EQ(motion.to[1] == motion.from[1], row == 2 || row > 3) << row;
    EXPECT_EQ(motion.to[1]->mesh().x, anew.to[1]->mesh().x);
    EXPECT_EQ(farthest_move(*colliders, row), farthest_move(anew.from, anew.to));
    EXPECT_NEAR(farthest_move(*colliders, row), row == 1 ? 0.003 : row == 3 ? 0.001 : 0, 1e-15);
    before = motion.to;
  }
}

TEST(ColliderMotionTest, ARigidMotionCarriesPointsAlong) {
  const Collider from(box({-0.02, -0.01, 0}, {0.02, 0.01, 0.03}));
  const Eigen::Isometry3d motion = Eigen::Translation3d(0.01, -0.02, 0.005) *
                                   Eigen::AngleAxisd(0.4, Vector3d(1, 2, -1).normalized());
  Points3 x = from.mesh().x;
  for (int v = 0; v < x.rows(); ++v) x.row(v) = (motion * Vector3d(x.row(v))).transpose();
  const Collider to(from, x);
  for (const Vector3d& p : {Vector3d(0.001, 0.002, 0.031), Vector3d(0.022, 0.013, -0.004),
                            Vector3d(0.01, 0.004, 0.029)})
    EXPECT_LT((carried(from, to, p, farthest_move(from, to) + 1e-3, 1) - motion * p).norm(), 1e-9);
  const Vector3d far(0.2, 0, 0);  // the box moves by less than its distance
  EXPECT_EQ(carried(from, to, far, farthest_move(from, to) + 1e-3, 1), far);
}

TEST(ColliderMotionTest, PushOutKnowsWhoHasComeOverTheRimOfABin) {
  // the front is outside; facets are above the rim, and the smooth surface hangs below it
  const auto colliders = all({bin(0.05)});
  Points3 facets(3, 3), x(3, 3);
  facets << 0.0485, 0, 1e-4, 0.0515, 0, 1e-4, 0.051, 0, -0.01;
  x << 0.0485, 0, -3e-4, 0.0515, 0, -3e-4, 0.0499, 0, -0.01;
  const Points3 before = x;
  push_out(shapes_at(*colliders, 0), facets, 0, x);
  EXPECT_EQ(x.topRows(2), before.topRows(2));  // on either side of the wall, over its rim
  EXPECT_NEAR(x(2, 0), 0.05, 1e-12);           // through the wall
}

TEST(ColliderMotionTest, PushOutMovesOnlyWhatIsInsideTheGround) {
  const auto colliders = all({ground()});
  Points3 facets(2, 3), x(2, 3);
  facets << 0, 0, 1e-4, 0.01, 0, 2e-3;
  x << 0, 0, -1e-3, 0.01, 0, 1e-3;
  EXPECT_NEAR(push_out(shapes_at(*colliders, 0), facets, 0, x), 1e-3, 1e-12);
  EXPECT_NEAR(x(0, 2), 0, 1e-12);
  EXPECT_EQ(x(1, 2), 1e-3);
}

}  // namespace
}  // namespace paperbake
