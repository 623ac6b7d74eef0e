// How deep a surface lies in a collider, against closed forms and against dense samples.

#include "core/geometry/collider_depth.h"

#include "tests/core/collider_meshes.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace paperbake {
namespace {

using test::box;
using test::hex_sheet;

/// The block (0, 2)^3 without its quarter x > 1, z > 1: it is not convex. [cm]
ColliderMesh step() {
  const double u = 0.01;
  ColliderMesh mesh{"step", Points3(12, 3), Triangles(20, 3), {}};
  const double outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (int v = 0; v < 6; ++v)
    for (int side = 0; side < 2; ++side)
      mesh.x.row(6 * side + v) << u * outline[v][0], side * 2 * u, u * outline[v][1];
  int t = 0;
  const int caps[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  for (const auto& cap : caps) {
    mesh.triangles.row(t++) << cap[0], cap[1], cap[2];
    mesh.triangles.row(t++) << 6 + cap[0], 6 + cap[2], 6 + cap[1];
  }
  for (int v = 0; v < 6; ++v) {
    const int w = (v + 1) % 6;
    mesh.triangles.row(t++) << v, 6 + v, 6 + w;
    mesh.triangles.row(t++) << v, 6 + w, w;
  }
  return mesh;
}

/// One triangle.
struct Alone {
  Points3 x{3, 3};
  Triangles triangles{1, 3};
  Alone(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    x << a.transpose(), b.transpose(), c.transpose();
    triangles << 0, 1, 2;
  }
};

Vector3d at(const Penetration& found, const Points3& x, const Triangles& triangles) {
  Vector3d p = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) p += found.weights[i] * x.row(triangles(found.triangle, i));
  return p;
}

TEST(ColliderDepth, OutsideOfAMeshThatHoldsThePaperEveryPointIsDeep) {
  ColliderMesh cage = box({0, 0, 0}, {0.1, 0.1, 0.1});
  cage.paper_side = ColliderMesh::PaperSide::inside;
  const ColliderDepth hollow(cage);
  const Alone within({0.02, 0.02, 0.05}, {0.08, 0.02, 0.05}, {0.02, 0.08, 0.05}),
      through({0.02, 0.02, 0.05}, {0.105, 0.02, 0.05}, {0.02, 0.08, 0.05}),
      beyond({0.02, 0.02, 0.12}, {0.08, 0.02, 0.12}, {0.02, 0.08, 0.13});
  EXPECT_EQ(hollow.deepest(within.x, within.triangles).depth, 0);
  EXPECT_NEAR(hollow.deepest(through.x, through.triangles).depth, 0.005, 1e-4);
  EXPECT_NEAR(hollow.deepest(beyond.x, beyond.triangles).depth, 0.03, 4e-4);
}

TEST(ColliderDepth, APencilThroughTheMiddleOfATriangleIsFoundThoughNoVertexIsInIt) {
  const ColliderDepth pencil(box({-0.002, -0.002, -0.05}, {0.002, 0.002, 0.05}));
  const Alone big({-0.02, -0.02, 0.01}, {0.02, -0.02, 0.01}, {0, 0.03, 0.01});
  const Penetration found = pencil.deepest(big.x, big.triangles);
  EXPECT_NEAR(found.depth, 0.002, 2e-6);
  EXPECT_LT(at(found, big.x, big.triangles).head<2>().norm(), 3e-6);
}

TEST(ColliderDepth, AnyDepthIsTold) {
  const Sheet sheet = hex_sheet(0.2, 0.2, 40);  // in the plane z = 0
  for (const double half : {1e-4, 1e-3, 0.01, 0.05})
    for (const double off : {0.0, 0.3, 0.9}) {
      const ColliderDepth plate(box({-1, -1, (off - 1) * half}, {1, 1, (off + 1) * half}));
      const double truth = (1 - off) * half;
      EXPECT_NEAR(plate.deepest(sheet.x, sheet.triangles).depth, truth, 2e-6 + 0.01 * truth)
          << half << " " << off;
    }
}

TEST(ColliderDepth, ASheetThatIsOutsideHasNone) {
  const Sheet sheet = hex_sheet(0.2, 0.2, 40);
  const ColliderDepth under(box({-1, -1, -0.1}, {1, 1, -1e-7})),
      above(box({0.05, 0.05, 1e-7}, {0.1, 0.1, 0.1}));
  EXPECT_EQ(under.deepest(sheet.x, sheet.triangles).depth, 0);
  EXPECT_EQ(above.deepest(sheet.x, sheet.triangles).depth, 0);
}

TEST(ColliderDepth, TheOrientationOfAClosedMeshDoesNotMatter) {
  ColliderMesh mesh = box({0.05, 0.05, -0.01}, {0.1, 0.1, 0.02});
  const Sheet sheet = hex_sheet(0.2, 0.2, 40);
  EXPECT_NEAR(ColliderDepth(mesh).deepest(sheet.x, sheet.triangles).depth, 0.01, 1e-4);
  mesh.triangles.col(1).swap(mesh.triangles.col(2));
  EXPECT_NEAR(ColliderDepth(mesh).deepest(sheet.x, sheet.triangles).depth, 0.01, 1e-4);
}

/// Depth of a point in the step: the distance from what is outside.
double depth_in_step(const Vector3d& p) {
  const double u = 0.01;
  const double x = p.x(), y = p.y(), z = p.z();
  const auto in_block = [](double q, double low, double high) {
    return std::min(q - low, high - q);
  };
  const double in_y = in_block(y, 0, 2 * u);
  const double low = std::min({in_block(x, 0, 2 * u), z, in_y});
  if (low <= 0 || in_block(z, 0, 2 * u) <= 0 || (x >= u && z >= u)) return 0;
  const double notch = std::hypot(std::max(u - x, 0.0), std::max(u - z, 0.0));
  return std::min({low, in_block(z, 0, 2 * u), notch});
}

TEST(ColliderDepth, RandomTrianglesInASolidThatIsNotConvexAgreeWithDenseSamples) {
  const ColliderDepth solid(step());
  std::mt19937 draws(3);
  std::uniform_real_distribution<double> place(-0.005, 0.025), size(0.2, 1);
  int inside = 0;
  for (int k = 0; k < 200; ++k) {
    const auto point = [&] { return Vector3d(place(draws), place(draws), place(draws)); };
    const Vector3d a = point();
    const double shrink = size(draws);
    const Alone one(a, a + shrink * (point() - a), a + shrink * (point() - a));
    const double found = solid.deepest(one.x, one.triangles).depth;
    constexpr int n = 150;
    double sampled = 0;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        sampled = std::max(
            sampled,
            depth_in_step(
                (i * one.x.row(0) + j * one.x.row(1) + (n - i - j) * one.x.row(2)).transpose() /
                n));
    inside += sampled > 1e-3;
    // the depth changes by no more than the distance to the nearest sample
    EXPECT_GE(found, sampled - 3e-6 - 0.01 * sampled) << k;
    EXPECT_LE(found, sampled + 0.03 / n) << k;
  }
  EXPECT_GT(inside, 60);
}

TEST(ColliderDepth, AnOpenMeshCountsWhatHasComeThroughItAndNotWhatHasComeRoundIt) {
  ColliderMesh ground{"ground", Points3(4, 3), Triangles(2, 3), {}};
  ground.x << -0.5, -0.5, 0, 0.1, -0.5, 0, 0.1, 0.5, 0, -0.5, 0.5, 0;
  ground.triangles << 0, 1, 2, 0, 2, 3;
  const ColliderDepth open(ground);
  Sheet sheet = hex_sheet(0.2, 0.2, 80);
  sheet.x.col(2).setConstant(1e-6);
  EXPECT_EQ(open.deepest(sheet.x, sheet.triangles).depth, 0);

  // a valley whose bottom is 4 mm behind the front
  Sheet valley = sheet;
  for (int v = 0; v < valley.x.rows(); ++v)
    valley.x(v, 2) = 0.5 * std::abs(sheet.x(v, 0) - 0.04) - 0.004;
  const double lowest = -valley.x.col(2).minCoeff();
  EXPECT_GT(lowest, 0.002);
  EXPECT_NEAR(open.deepest(valley.x, valley.triangles).depth, lowest, 1e-4);

  // round its border and back under it
  Sheet round = sheet;
  for (int v = 0; v < round.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0), turn = std::clamp((s - 0.08) / 0.01, 0.0, M_PI);
    round.x(v, 0) = 0.11 + (s < 0.08 ? s - 0.08 : 0.01 * std::sin(turn)) - 0.01 -
                    std::max(0.0, s - 0.08 - 0.01 * M_PI);
    round.x(v, 2) = 0.01 * std::cos(turn);
  }
  EXPECT_LT(round.x.col(2).minCoeff(), -0.009);
  EXPECT_EQ(open.deepest(round.x, round.triangles).depth, 0);
}

TEST(ColliderDepth, ATriangleWithACornerInAnOpenMeshIsAsDeepAsItGoes) {
  // CGAL's intersection of two triangles fails for many of these
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int k = 0; k < 500; ++k) {
    const double z = 0.003 * uniform(random);
    ColliderMesh plate{"plate", Points3(4, 3), Triangles(2, 3), {}};
    plate.x << -0.2, -0.01, z, 0, -0.01, z, 0, 0.11, z, -0.2, 0.11, z;
    plate.triangles << 0, 1, 2, 0, 2, 3;
    const auto beside = [&](double up) -> Vector3d {
      return {-0.1 + 1e-3 * uniform(random), 0.05 + 1e-3 * uniform(random), z + up};
    };
    const double down = 1e-3 * uniform(random);
    const Alone touching(beside(0), beside(1e-3 * uniform(random)), beside(-down));
    EXPECT_NEAR(ColliderDepth(plate).deepest(touching.x, touching.triangles).depth, down, 1e-5);
  }
}

TEST(ColliderDepth, WhatHangsOverABorderIsAsDeepAsItHasCutIn) {
  // a wall whose upper border is 0.2 mm above a sheet that reaches 50 mm beyond it on either side
  ColliderMesh wall{"wall", Points3(4, 3), Triangles(2, 3), {}};
  wall.x << 0.05, -1, -1, 0.05, 1, -1, 0.05, 1, 2e-4, 0.05, -1, 2e-4;
  wall.triangles << 0, 1, 2, 0, 2, 3;
  Sheet sheet = hex_sheet(0.1, 0.1, 40);
  EXPECT_NEAR(ColliderDepth(wall).deepest(sheet.x, sheet.triangles).depth, 2e-4, 1e-9);
  wall.x.col(2).array() += 0.01;  // which passes right through it
  EXPECT_NEAR(ColliderDepth(wall).deepest(sheet.x, sheet.triangles).depth, 0.0102, 1e-9);
}

TEST(ColliderDepth, BoxesThatATriangleWithoutAreaJoinsAreNotOneConvexSolid) {
  ColliderMesh both = box({0, 0, -0.01}, {0.02, 0.02, 0.01});
  const ColliderMesh other = box({0.06, 0, -0.01}, {0.08, 0.02, 0.01});
  both.x.conservativeResize(16, 3);
  both.x.bottomRows(8) = other.x;
  both.triangles.conservativeResize(25, 3);
  both.triangles.middleRows(12, 12) = other.triangles.array() + 8;
  both.triangles.row(24) << 0, 8, 8;
  Sheet sheet = hex_sheet(0.09, 0.02, 200);
  EXPECT_NEAR(ColliderDepth(both).deepest(sheet.x, sheet.triangles).depth, 0.01, 1e-4);
}

}  // namespace
}  // namespace paperbake
