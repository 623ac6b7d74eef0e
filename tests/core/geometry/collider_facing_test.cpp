#include "core/geometry/collider_facing.h"

#include "tests/core/collider_meshes.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <utility>

namespace paperbake {
namespace {

using test::bin;
using test::box;
using test::ground;

TEST(ColliderFacingTest, TrianglesThatFaceTheOtherWayAreTurnedAndMostStay) {
  for (const ColliderMesh& mesh : {test::ball(0.05, 12, 8), bin(0.1)}) {
    Triangles flipped = mesh.triangles;
    int few = 0;
    for (int t = 0; t < flipped.rows(); ++t)
      if (t % 3 == 1) {
        std::swap(flipped(t, 1), flipped(t, 2));
        ++few;
      }
    EXPECT_EQ(turn_to_neighbours(flipped), few);
    EXPECT_EQ(flipped, mesh.triangles);
    EXPECT_EQ(turn_to_neighbours(flipped), 0);
  }
  // a band that is closed after half a twist has one side
  Triangles band(6, 3);
  band << 0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4, 4, 5, 1, 5, 0, 1;
  Triangles again = band;
  turn_to_neighbours(again);
  EXPECT_EQ(turn_to_neighbours(again), 0) << "it does not go on and on";
}

TEST(ColliderFacingTest, ASheetThatBeginsInAClosedMeshStaysInsideUnlessTheMeshSaysOtherwise) {
  using Side = ColliderMesh::PaperSide;
  Points3 inner(3, 3), half(3, 3);
  inner << 0.4, 0.4, 0.5, 0.6, 0.4, 0.5, 0.5, 0.6, 0.5;
  half << 0.4, 0.4, 0.5, 0.6, 0.4, 0.5, 0.5, 1.6, 0.5;
  for (const bool inside_out : {false, true}) {
    std::vector<ColliderMesh> cage{box({0, 0, 0}, {1, 1, 1}, inside_out)};
    face_the_sheet(cage, half, Points3(0, 3));
    EXPECT_EQ(cage[0].paper_side, Side::outside);
    cage[0].paper_side = Side::automatic;
    face_the_sheet(cage, inner, Points3(0, 3));
    EXPECT_EQ(cage[0].paper_side, Side::inside);
    const Collider hollow(cage[0]);
    EXPECT_TRUE(hollow.closed());
    EXPECT_NEAR(hollow.nearest({0.5, 0.5, 0.9}, 2, 1).distance, 0.1, 1e-12);
    EXPECT_NEAR(hollow.nearest({0.5, 0.5, 1.2}, 2, 1).distance, -0.2, 1e-12);
    EXPECT_LT(hollow.nearest({0.5, 0.5, 0.9}, 2, 1).normal.z(), -0.99);
    EXPECT_EQ(Collider(hollow, hollow.mesh().x).mesh().paper_side, Side::inside);
    cage[0].paper_side = Side::outside;
    face_the_sheet(cage, inner, Points3(0, 3));
    EXPECT_EQ(cage[0].paper_side, Side::outside);
  }
}

TEST(ColliderFacingTest, OpenMeshFacesTheSheetAndUpwardsWhereTheSheetLiesInIt) {
  for (const double height : {0.01, -0.01, 0.0}) {
    std::vector<ColliderMesh> meshes{ground()};
    Points3 x(3, 3);
    x << 0, 0, height, 0.1, 0, height, 0, 0.1, height;
    meshes[0].triangles.col(1).swap(meshes[0].triangles.col(2));
    face_the_sheet(meshes, x, Points3(0, 3));
    EXPECT_EQ(Collider(meshes[0]).nearest({0.01, 0.02, 0.001}, 1, 1).distance > 0, height >= 0)
        << height;
  }
}

TEST(ColliderFacingTest, AnOpenMeshFacesASheetThatBeginsBesideItAsIfItWentOn) {
  // of a table: 3 mm below its level, above it, and on both sides of it
  for (const double height : {-0.003, 0.003, 0.0})
    for (const bool turned : {false, true}) {
      std::vector<ColliderMesh> meshes{ground()};
      const double edge = meshes[0].x.col(0).maxCoeff();
      Points3 x(3, 3);
      x << edge, 0, height, edge + 0.1, 0, height - 0.001, edge, 0.1, height + 0.001;
      if (turned) meshes[0].triangles.col(1).swap(meshes[0].triangles.col(2));
      face_the_sheet(meshes, x, Points3(0, 3));
      const Collider facing(meshes[0]);
      EXPECT_EQ(facing.nearest({0.01, 0.02, 0.001}, 1, 1).distance > 0, height >= 0) << height;
      // and a handle that is keyed to go over it or under it knows better
      Points3 keyed(1, 3);
      keyed << 0.01, 0.02, -height;
      face_the_sheet(meshes, x, keyed);
      EXPECT_EQ(Collider(meshes[0]).nearest({0.01, 0.02, 0.001}, 1, 1).distance > 0, height <= 0);
    }
}

TEST(ColliderFacingTest, ASheetLevelWithTheRimOfABinLeavesItsFrontInside) {
  // three quarters of its vertices are beside the mouth: beyond the border there is no front
  std::vector<ColliderMesh> meshes{bin(0.05)};
  Sheet sheet = test::hex_sheet(0.2, 0.2, 60);
  sheet.x.rowwise() -= Eigen::RowVector3d(0.1, 0.1, -1e-3);
  face_the_sheet(meshes, sheet.x, Points3(0, 3));
  EXPECT_GT(Collider(meshes[0]).nearest({0, 0, -0.05}, 1, 1).distance, 0);
}

}  // namespace
}  // namespace paperbake
