#include "core/geometry/judged_colliders.h"

#include "tests/core/collider_meshes.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace paperbake {
namespace {

using test::box;
using test::hex_sheet;

/// A collider that is in each of these poses in one frame.
ColliderMesh posed(ColliderMesh mesh, const std::vector<Eigen::Affine3d>& poses) {
  const Points3 rest = mesh.x;
  for (const Eigen::Affine3d& pose : poses)
    mesh.frames.own().push_back((rest * pose.linear().transpose()).rowwise() +
                                pose.translation().transpose());
  mesh.x = mesh.frames[0];
  return mesh;
}

TEST(JudgedCollidersTest, AreAskedWhereTheyAreInTheFrame) {
  const Sheet sheet = hex_sheet(0.2, 0.2, 40);
  const ColliderMesh cube = box({0.1, 0.1, 0.001}, {0.11, 0.11, 0.011}),
                     rod = box({-0.004, -0.004, -0.05}, {0.004, 0.004, 0.05});
  const Vector3d slanted = (Vector3d::UnitX() + Vector3d::UnitY()).normalized();
  const Eigen::Affine3d far(Eigen::Translation3d(0.1, 0.1, 0.2)),
      through(Eigen::Translation3d(0.06, 0.07, 0) * Eigen::AngleAxisd(0.4, slanted)),
      thinner(through * Eigen::Scaling(0.5, 0.5, 1.0));
  const JudgedColliders colliders({cube, posed(rod, {far, through, thinner})});
  EXPECT_EQ(colliders.deepest(0, sheet.x, sheet.triangles).depth, 0);
  for (const auto& [row, depth] : {std::pair(1, 0.004), {2, 0.002}, {7, 0.002}}) {
    const ColliderPenetration found = colliders.deepest(row, sheet.x, sheet.triangles);
    EXPECT_EQ(found.collider, 1u);
    EXPECT_NEAR(found.depth, depth, 1e-4) << row;
    const Vector3d at = sheet.x(sheet.triangles.row(found.triangle), Eigen::all).transpose() *
                        found.weights;  // on the axis of the rod
    EXPECT_LT((at.head<2>() - Eigen::Vector2d(0.06, 0.07)).norm(), 1e-3);
  }
}

TEST(JudgedCollidersTest, APlateOfTwoTrianglesKeepsItsFrontHoweverItIsTurned) {
  // a sheet that reaches 3 mm behind the plate on one side, and 5 mm before it on the other
  const Vector3d about = Vector3d(1, 2, -1).normalized();
  ColliderMesh plate = test::ground(0.3);
  const Sheet flat = hex_sheet(0.1, 0.1, 200);
  for (const double degrees : {0.0, 90.0, 180.0, 250.0}) {
    const Eigen::Affine3d pose(Eigen::Translation3d(0.2, -0.1, 0.3) *
                               Eigen::AngleAxisd(degrees * M_PI / 180, about));
    const JudgedColliders colliders({posed(plate, {Eigen::Affine3d::Identity(), pose})});
    Points3 x = flat.x;
    x.col(2) = 0.005 - 0.08 * x.col(0).array();
    const Points3 there =
        (x * pose.linear().transpose()).rowwise() + pose.translation().transpose();
    EXPECT_NEAR(colliders.deepest(1, there, flat.triangles).depth, 0.003, 1e-6) << degrees;
  }
}

TEST(JudgedCollidersTest, AMirroredColliderIsNotTakenForATurnedOne) {
  // a wedge that reaches through the sheet on one side of a plane only
  ColliderMesh wedge = box({0, 0, -0.01}, {0.05, 0.02, 0.01});
  wedge.x(0, 2) = 0.005;  // no mirror image of it is itself turned
  const Sheet sheet = hex_sheet(0.2, 0.2, 40);
  const auto at = [&](double side) {
    return posed(wedge, {Eigen::Affine3d(Eigen::Translation3d(0.3, 0.1, 0)),
                         Eigen::Affine3d(Eigen::Translation3d(0.1, 0.1, 0) *
                                         Eigen::Scaling(side, 1.0, 1.0))});
  };
  for (const double side : {1.0, -1.0}) {
    ColliderMesh alone = at(side);
    alone.x = alone.frames[1];
    alone.frames = {};
    const ColliderPenetration found =
        JudgedColliders({at(side)}).deepest(1, sheet.x, sheet.triangles);
    const Penetration expected = ColliderDepth(alone).deepest(sheet.x, sheet.triangles);
    EXPECT_GT(expected.depth, 0.001);
    EXPECT_NEAR(found.depth, expected.depth, 1e-9) << side;
    EXPECT_EQ(found.triangle, expected.triangle) << side;
  }
}

}  // namespace
}  // namespace paperbake
