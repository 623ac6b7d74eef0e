// What an artist has put on a sheet, on another mesh of it: exact at every corner, on the right
// side of seams.

#include "core/geometry/surface_transfer.h"

#include "core/render/render_mesh.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// 0.2 x 0.1 m in four quads side by side; uv set "skew" is one affine map, "cut" another one right
/// of the middle, where the material changes too.
AuthoredSurface four_quads() {
  AuthoredSurface a;
  a.pattern.resize(10, 2);
  for (int i = 0; i < 5; ++i) {
    a.pattern.row(i) << 0.05 * i, 0;
    a.pattern.row(5 + i) << 0.05 * i, 0.1;
  }
  a.triangles.resize(8, 3);
  for (int q = 0; q < 4; ++q) {
    a.triangles.row(2 * q) << q, q + 1, q + 6;
    a.triangles.row(2 * q + 1) << q, q + 6, q + 5;
  }
  a.attributes = {{"skew", AttributeKind::uv, AttributeValues(24, 2)},
                  {"cut", AttributeKind::uv, AttributeValues(24, 2)}};
  a.materials = {"paper", "print"};
  for (int t = 0; t < 8; ++t) {
    const bool right = t >= 4;
    a.material_of.push_back(right);
    for (int k = 0; k < 3; ++k) {
      const Vector2d p = a.pattern.row(a.triangles(t, k));
      a.attributes[0].values.row(3 * t + k) << 3 * p.x() + p.y() + 0.1, 2 * p.y() - p.x();
      a.attributes[1].values.row(3 * t + k) << (right ? p.x() + 5 : 2 * p.x()), p.y();
    }
  }
  return a;
}

Eigen::VectorXd corner(const MeshSurface::Attribute& attribute, int t, int k) {
  return attribute.values.row(attribute.of_corner(t, k));
}

TEST(SurfaceTransfer, SeamsAreStraightLinesWhereSomethingJumps) {
  const auto found = seams(four_quads());
  ASSERT_EQ(found.size(), 1u);  // not the edges inside of one side
  EXPECT_NEAR(found[0].first.x(), 0.1, 1e-12);
  EXPECT_NEAR(found[0].second.x(), 0.1, 1e-12);
  EXPECT_NEAR((found[0].first - found[0].second).norm(), 0.1, 1e-12);
  AuthoredSurface plain = four_quads();
  plain.attributes.pop_back();
  EXPECT_EQ(seams(plain).size(), 1u) << "the border of the material";
  plain.material_of.clear();
  EXPECT_TRUE(seams(plain).empty());
}

TEST(SurfaceTransfer, ASeamOfManySmallEdgesIsOneLine) {
  AuthoredSurface a;  // 2 x 3 quads, cut in the middle
  a.pattern.resize(12, 2);
  for (int v = 0; v < 12; ++v) a.pattern.row(v) << v % 3, v / 3;
  a.triangles.resize(12, 3);
  for (int q = 0; q < 6; ++q) {
    const int v = q / 2 * 3 + q % 2;
    a.triangles.row(2 * q) << v, v + 1, v + 4;
    a.triangles.row(2 * q + 1) << v, v + 4, v + 3;
  }
  for (int t = 0; t < 12; ++t) a.material_of.push_back(t / 2 % 2);
  a.materials = {"a", "b"};
  const auto found = seams(a);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR((found[0].first - found[0].second).norm(), 3, 1e-12);
}

TEST(SurfaceTransfer, EveryCornerOfAFineMeshHasTheAuthoredUvOfItsSideOfTheSeam) {
  const AuthoredSurface authored = four_quads();
  RenderFeatures features;
  for (const auto& [a, b] : seams(authored)) features.seams.push_back({a, b});
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.2, 0.1), 0.007, features);
  EXPECT_EQ(mesh.simulated_edges, SimulatedEdges::none);
  const MeshSurface surface = surface_on(authored, mesh.pattern, mesh.triangles);
  ASSERT_EQ(surface.attributes.size(), 2u);
  EXPECT_EQ(surface.attributes[0].values.rows(), mesh.pattern.rows())
      << "one value a vertex: no seam";
  EXPECT_GT(surface.attributes[1].values.rows(), mesh.pattern.rows() + 10) << "two along the seam";
  EXPECT_LT(surface.attributes[1].values.rows(), mesh.pattern.rows() + 30);
  int sides[2] = {0, 0};
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    double low = 1, high = 0;
    for (int k = 0; k < 3; ++k) {
      low = std::min(low, mesh.pattern(mesh.triangles(t, k), 0));
      high = std::max(high, mesh.pattern(mesh.triangles(t, k), 0));
    }
    ASSERT_TRUE(high <= 0.1 + 1e-9 || low >= 0.1 - 1e-9) << "a triangle crosses the seam";
    const bool right = low >= 0.1 - 1e-9;
    ++sides[right];
    EXPECT_EQ(surface.material_of[t], right);
    for (int k = 0; k < 3; ++k) {
      const Vector2d p = mesh.pattern.row(mesh.triangles(t, k));
      const Vector2d skew(3 * p.x() + p.y() + 0.1, 2 * p.y() - p.x()),
          cut(right ? p.x() + 5 : 2 * p.x(), p.y());
      EXPECT_LT((corner(surface.attributes[0], t, k) - skew).norm(), 1e-6);
      EXPECT_LT((corner(surface.attributes[1], t, k) - cut).norm(), 5e-6);
    }
  }
  EXPECT_GT(std::min(sides[0], sides[1]), 100);
}

/// The same sheet with a colour that jumps in the middle, and a small number that is linear.
AuthoredSurface dyed_quads() {
  AuthoredSurface a = four_quads();
  a.materials.clear();
  a.material_of.clear();
  a.attributes = {{"dye", AttributeKind::colour, AttributeValues(24, 4)},
                  {"thickness", AttributeKind::number, AttributeValues(24, 1)}};
  for (int t = 0; t < 8; ++t)
    for (int k = 0; k < 3; ++k) {
      const Vector2d p = a.pattern.row(a.triangles(t, k));
      a.attributes[0].values.row(3 * t + k) << (t < 4 ? 0.1 : 0.7), 4 * p.y(), 0.5, 1;
      a.attributes[1].values(3 * t + k, 0) = 1e-4 * (1 + 3 * p.x() - p.y());
    }
  return a;
}

TEST(SurfaceTransfer, AnAttributeIsExactAtItsCornersAndLinearBetweenThem) {
  const AuthoredSurface authored = dyed_quads();
  const MeshSurface same = surface_on(authored, authored.pattern, authored.triangles);
  ASSERT_EQ(same.attributes.size(), 2u);
  for (int n = 0; n < 2; ++n)
    for (int t = 0; t < 8; ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_LT((corner(same.attributes[n], t, k) -
                   authored.attributes[n].values.row(3 * t + k).transpose())
                      .norm(),
                  1e-12)  // only products with weights 0 and 1
            << n << ", triangle " << t << ", corner " << k;
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.2, 0.1), 0.007, RenderFeatures());
  const MeshSurface fine = surface_on(authored, mesh.pattern, mesh.triangles);
  EXPECT_EQ(fine.attributes[1].name, "thickness");
  EXPECT_EQ(fine.attributes[1].kind, AttributeKind::number);
  EXPECT_EQ(fine.attributes[1].values.rows(), mesh.pattern.rows()) << "what is smooth shares rows";
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vector2d p = mesh.pattern.row(mesh.triangles(t, k));
      EXPECT_NEAR(corner(fine.attributes[1], t, k)[0], 1e-4 * (1 + 3 * p.x() - p.y()), 1e-9);
    }
}

TEST(SurfaceTransfer, AColourThatJumpsAtFacesKeepsItsValueOnBothSides) {
  const AuthoredSurface authored = dyed_quads();
  EXPECT_TRUE(seams(authored).empty()) << "of no uv set and no material";
  const auto found = jumps(authored);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].first.x(), 0.1, 1e-12);
  EXPECT_NEAR((found[0].first - found[0].second).norm(), 0.1, 1e-12);
  RenderFeatures features;
  features.jumps.push_back({found[0].first, found[0].second});
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.2, 0.1), 0.007, features);
  const MeshSurface surface = surface_on(authored, mesh.pattern, mesh.triangles);
  EXPECT_GT(surface.attributes[0].values.rows(), mesh.pattern.rows() + 10) << "two along the seam";
  int sides[2] = {0, 0};
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const bool right =
        (mesh.pattern(mesh.triangles(t, 0), 0) + mesh.pattern(mesh.triangles(t, 1), 0) +
         mesh.pattern(mesh.triangles(t, 2), 0)) /
            3 >
        0.1;
    ++sides[right];
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(corner(surface.attributes[0], t, k)[0], right ? 0.7 : 0.1, 1e-9);
  }
  EXPECT_GT(std::min(sides[0], sides[1]), 100);
}

TEST(SurfaceTransfer, AJumpOfASmallNumberCounts) {
  AuthoredSurface authored = dyed_quads();
  authored.attributes.erase(authored.attributes.begin());
  EXPECT_TRUE(jumps(authored).empty());
  for (int row = 12; row < 24; ++row) authored.attributes[0].values(row, 0) += 1e-6;
  EXPECT_EQ(jumps(authored).size(), 1u);
  authored.material_of = {0, 0, 0, 0, 1, 1, 1, 1};
  EXPECT_EQ(seams(authored).size(), 1u);
  EXPECT_TRUE(jumps(authored).empty()) << "there is a seam";
}

TEST(SurfaceTransfer, LargeNumbersOfFacesAreToldApart) {
  AuthoredSurface authored = dyed_quads();
  authored.attributes.erase(authored.attributes.begin());
  authored.attributes[0].values.setConstant(2e6);
  authored.attributes[0].values.bottomRows(12).array() += 1;
  EXPECT_EQ(jumps(authored).size(), 1u);
}

TEST(SurfaceTransfer, WithoutRoomForSeamsTheMeshIsThatWithoutThem) {
  RenderFeatures features, none;
  for (int k = 1; k < 200; ++k)
    features.seams.push_back({Vector2d(0, k * 5e-4), Vector2d(0.1, k * 5e-4)});
  const RenderMesh with = mesh_for_render(test::rectangle(0.1, 0.1), 0.01, features),
                   without = mesh_for_render(test::rectangle(0.1, 0.1), 0.01, none);
  ASSERT_EQ(with.triangles.rows(), without.triangles.rows());
  EXPECT_EQ(with.triangles, without.triangles);
}

TEST(SurfaceTransfer, JumpsWithoutRoomLeaveTheSeams) {
  RenderFeatures seam, both;
  seam.seams = {{Vector2d(0.05, 0), Vector2d(0.05, 0.1)}};
  both.seams = seam.seams;
  for (int k = 1; k < 200; ++k)
    both.jumps.push_back({Vector2d(0, k * 5e-4), Vector2d(0.1, k * 5e-4)});
  const RenderMesh with = mesh_for_render(test::rectangle(0.1, 0.1), 0.01, both),
                   without = mesh_for_render(test::rectangle(0.1, 0.1), 0.01, seam);
  ASSERT_EQ(with.triangles.rows(), without.triangles.rows());
  EXPECT_EQ(with.triangles, without.triangles);
  EXPECT_EQ(with.pattern, without.pattern);
}

}  // namespace
}  // namespace paperbake
