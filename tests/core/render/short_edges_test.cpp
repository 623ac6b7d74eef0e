#include "core/render/short_edges.h"

#include "core/render/render_mesh.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

double shortest_edge(const Points2& pattern, const Triangles& triangles) {
  double least = 1;
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      least = std::min(
          least, (pattern.row(triangles(t, i)) - pattern.row(triangles(t, (i + 1) % 3))).norm());
  return least;
}

Sheet as_sheet(const RenderMesh& mesh) {
  Sheet sheet;
  sheet.pattern = mesh.pattern;
  sheet.triangles = mesh.triangles;
  return sheet;
}

/// Three simulated edges that cross each other within two micrometres, one that ends a micrometre
/// beside a corner of the border, and a fourth that ends beside another end on the border.
RenderFeatures near_crossings() {
  RenderFeatures features;
  features.points = {{0.03, 0.04}};
  features.edges = {{{0.02, 0.03}, {0.08, 0.07}},
                    {{0.02, 0.07}, {0.08, 0.03}},
                    {{0.05 + 2e-6, 0.02}, {0.05 + 2e-6, 0.1}},
                    {{0.02, 0.07}, {0.05, 0.1}},
                    {{0.02, 0.07}, {0.1, 0.1 - 1e-6}}};
  return features;
}

TEST(ShortEdgesTest, LinesThatCrossBesideEachOtherShareAVertex) {
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.003, near_crossings());
  ASSERT_EQ(mesh.simulated_edges, SimulatedEdges::kept);
  EXPECT_GT(shortest_edge(mesh.pattern, mesh.triangles), 0.02 * 0.003)
      << "a micrometre without that: less than 32 bits hold ten metres from the origin";
  test::expect_sound(as_sheet(mesh), 0.01);
  EXPECT_LT((mesh.pattern.row(mesh.point_vertex[0]).transpose() - Vector2d(0.03, 0.04)).norm(),
            1e-12);
}

TEST(ShortEdgesTest, TheVerticesOfAnEdgeThatIsMergedBecomeOneAndCornersStay) {
  Points2 pattern(6, 2);
  pattern << 0, 0, 1, 0, 1, 1, 0, 1, 0.5, 0.5, 0.5, 0.501;
  Triangles triangles(6, 3);
  triangles << 0, 1, 4, 1, 2, 5, 1, 5, 4, 2, 3, 5, 3, 0, 4, 3, 4, 5;
  Points2 moved = pattern;
  Triangles left = triangles;
  const auto no_line = [](int, int) { return false; };
  const std::vector<int> became =
      merge_short_edges(moved, left, std::vector<char>(6, 0), no_line, 0.01);
  ASSERT_EQ(moved.rows(), 5);
  EXPECT_EQ(left.rows(), 4);
  EXPECT_EQ(became[4], became[5]);
  for (int corner = 0; corner < 4; ++corner)
    EXPECT_EQ(moved.row(became[corner]), pattern.row(corner));
  EXPECT_GT(shortest_edge(moved, left), 0.5);

  Points2 kept = pattern;
  EXPECT_EQ(merge_short_edges(kept, triangles, {0, 0, 0, 0, 1, 1}, no_line, 0.01).size(), 6u);
  EXPECT_EQ(kept, pattern) << "both are kept";
}

TEST(ShortEdgesTest, AVertexOnALineMovesAlongItAloneAndNotWhereItTurns) {
  Points2 pattern(5, 2);
  pattern << 0, 0, 2, 0, 1.001, 1, 1, 0.002, 1, 0;  // a triangle; 4 lies on its border
  Triangles triangles(4, 3);
  triangles << 0, 4, 3, 4, 1, 3, 1, 2, 3, 2, 0, 3;
  Points2 moved = pattern;
  Triangles left = triangles;
  const auto no_line = [](int, int) { return false; };
  const std::vector<int> became = merge_short_edges(moved, left, {0, 0, 0, 0, 0}, no_line, 0.01);
  ASSERT_EQ(moved.rows(), 4);
  EXPECT_EQ(moved.row(became[3]), pattern.row(4)) << "the one on the border stays";

  moved = pattern;
  left = triangles;
  const auto crease = [](int a, int b) { return a + b == 5 || a + b == 7; };  // 2-3 and 3-4
  merge_short_edges(moved, left, {0, 0, 0, 0, 0}, crease, 0.01);
  EXPECT_EQ(moved.rows(), 5) << "the crease turns at 3";
}

}  // namespace
}  // namespace paperbake
