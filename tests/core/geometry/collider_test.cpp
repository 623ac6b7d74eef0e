#include "core/geometry/collider.h"

#include "tests/core/collider_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

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

}  // namespace
}  // namespace paperbake
