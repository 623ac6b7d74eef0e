#include "core/geometry/collider_gap.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// A square plate of 200 mm through (0, 0, z) whose front looks along `up` or against it.
ColliderMesh plate(double z, bool faces_up, double slant = 0) {
  ColliderMesh mesh{"plate", Points3(4, 3), Triangles(2, 3), {}};
  const double h = 0.1, x = h * std::cos(slant), dz = h * std::sin(slant);
  mesh.x << -x, -h, z - dz, x, -h, z + dz, x, h, z + dz, -x, h, z - dz;
  mesh.triangles << 0, 1, 2, 0, 2, 3;
  if (!faces_up) mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

ColliderShapes all(const std::vector<ColliderMesh>& meshes) {
  ColliderShapes shapes;
  for (const ColliderMesh& mesh : meshes) shapes.push_back(std::make_shared<const Collider>(mesh));
  return shapes;
}

TEST(ColliderGapTest, AGapIsAsWideAsTheDistanceOfItsTwoFaces) {
  const ColliderShapes press = all({plate(0, true), plate(0.008, false)});
  for (const double z : {0.001, 0.004, 0.0079, -1e-4, 0.0081}) {
    const auto gap = gap_around(press, {0.01, 0.02, z}, 0.02);
    ASSERT_TRUE(gap) << z;
    EXPECT_NEAR(gap->width, 0.008, 1e-12) << z;
    EXPECT_NEAR(std::abs(gap->normal.z()), 1, 1e-12) << z;
  }
}

TEST(ColliderGapTest, TheNarrowestGapCounts) {
  const ColliderShapes shelf = all({plate(0, true), plate(0.008, false), plate(0.015, false)});
  EXPECT_NEAR(gap_around(shelf, {0, 0, 0.003}, 0.02)->width, 0.008, 1e-12);
}

TEST(ColliderGapTest, WhatIsWiderOrOpenOrNotFacingIsNoGap) {
  const Vector3d p{0, 0, 0.004};
  EXPECT_FALSE(gap_around(all({plate(0, true), plate(0.008, false)}), p, 0.0079));
  EXPECT_FALSE(gap_around(all({plate(0, true)}), p, 0.02));
  EXPECT_FALSE(gap_around({}, p, 0.02));
  EXPECT_FALSE(gap_around(all({plate(0, true), plate(0.002, true)}), p, 0.02));  // both below
  EXPECT_FALSE(gap_around(all({plate(0, true), plate(0.008, false)}), {0.11, 0, 0.004}, 0.03));
}

TEST(ColliderGapTest, FacesMayBeSlantedALittle) {
  const Vector3d p{0, 0, 0.004};
  EXPECT_TRUE(gap_around(all({plate(0, true), plate(0.008, false, 0.2)}), p, 0.02));
  EXPECT_FALSE(gap_around(all({plate(0, true), plate(0.008, false, 0.4)}), p, 0.02));
}

}  // namespace
}  // namespace paperbake
