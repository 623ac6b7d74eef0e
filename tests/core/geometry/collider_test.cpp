#include "core/geometry/collider.h"

#include "core/geometry/proximity.h"
#include "tests/core/collider_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace paperbake {
namespace {

using test::ball;
using test::box;
using test::ground;

TEST(ColliderTest, ClosedMeshKnowsItsInsideForEitherOrientation) {
  for (const bool inside_out : {false, true}) {
    const Collider collider(box({0, 0, 0}, {0.1, 0.1, 0.1}, inside_out));
    ASSERT_TRUE(collider.closed());
    EXPECT_NEAR(collider.nearest({0.05, 0.05, 0.103}, 0.1, 1).distance, 0.003, 1e-12);
    EXPECT_NEAR(collider.nearest({0.05, 0.05, 0.098}, 0.1, 1).distance, -0.002, 1e-12);
    // near an edge
    EXPECT_NEAR(collider.nearest({0.103, 0.05, 0.104}, 0.1, 1).distance, 0.005, 1e-12);
    // and near a corner
    EXPECT_NEAR(collider.nearest({0.1, 0.1, 0.1 + 0.002}, 0.1, 1).distance, 0.002, 1e-12);
  }
  EXPECT_FALSE(Collider(ground()).closed());
}

TEST(ColliderTest, EachPartOfAClosedMeshKnowsItsInside) {
  // a small and a large box in one mesh; either may be inside out
  const ColliderMesh small = box({0, 0, 0}, {0.1, 0.1, 0.1}),
                     large = box({0.2, 0, 0}, {0.4, 0.2, 0.2});
  for (int which = 0; which < 4; ++which)
    for (const bool holds : {false, true}) {
      ColliderMesh both = small;
      both.x.conservativeResize(16, 3);
      both.x.bottomRows(8) = large.x;
      both.triangles.conservativeResize(24, 3);
      both.triangles.bottomRows(12) = large.triangles.array() + 8;
      if (which & 1) both.triangles.topRows(12).col(1).swap(both.triangles.topRows(12).col(2));
      if (which & 2)
        both.triangles.bottomRows(12).col(1).swap(both.triangles.bottomRows(12).col(2));
      if (holds) both.paper_side = ColliderMesh::PaperSide::inside;
      const Collider collider(both);
      const double outside = holds ? -1 : 1;
      EXPECT_NEAR(collider.nearest({0.05, 0.05, 0.102}, 0.1, 1).distance, outside * 0.002, 1e-12);
      EXPECT_NEAR(collider.nearest({0.05, 0.05, 0.098}, 0.1, 1).distance, -outside * 0.002, 1e-12);
      EXPECT_NEAR(collider.nearest({0.3, 0.1, 0.202}, 0.1, 1).distance, outside * 0.002, 1e-12);
      EXPECT_NEAR(collider.nearest({0.3, 0.1, 0.198}, 0.1, 1).distance, -outside * 0.002, 1e-12);
    }
}

TEST(ColliderTest, TheNearestPointIsThatOfAllTrianglesWhateverItsShape) {
  ColliderMesh mesh = ball(0.05, 24, 12);
  Points3 x = mesh.x;
  x.col(0) *= 0.4;
  x.col(1) = x.col(1).array() + 3 * x.col(2).array().square();
  mesh.frames.own() = {mesh.x, x};
  const Collider first(mesh), bent(first, x);
  ASSERT_TRUE(bent.closed());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> anywhere(-0.1, 0.1);
  for (const Collider* collider : {&first, &bent}) {
    const Points3& at = collider->mesh().x;
    int near = 0;
    for (int k = 0; k < 500; ++k) {
      const Vector3d p(anywhere(random), anywhere(random), anywhere(random));
      double least = 1;
      for (int t = 0; t < collider->mesh().triangles.rows(); ++t) {
        const auto corner = [&](int i) {
          return at.row(collider->mesh().triangles(t, i)).transpose();
        };
        least =
            std::min(least, vertex_to_triangle({p, corner(0), corner(1), corner(2)}).distance());
      }
      // in the last digit the test may round in another way than the library it is linked with
      EXPECT_DOUBLE_EQ(std::abs(collider->nearest(p, 1, 1).distance), least);
      const double within = 0.03, distance = collider->nearest(p, within, 1).distance;
      EXPECT_DOUBLE_EQ(std::abs(distance), least <= within ? least : INFINITY);
      near += least <= within;
    }
    EXPECT_TRUE(50 < near && near < 450) << near;
  }
}

}  // namespace
}  // namespace paperbake
