#include "core/geometry/mesh_edges.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A square 0 1 2 3 around its middle 4.
Triangles four_around_the_middle() {
  Triangles triangles(4, 3);
  triangles << 2, 3, 4, 0, 1, 4, 3, 0, 4, 1, 2, 4;
  return triangles;
}

TEST(MeshEdges, AreFoundOnceInOrder) {
  std::vector<std::pair<int, int>> ends;
  for (const MeshEdge& edge : MeshEdges(four_around_the_middle()))
    ends.emplace_back(edge.low, edge.high);
  const std::vector<std::pair<int, int>> expected{{0, 1}, {0, 3}, {0, 4}, {1, 2},
                                                  {1, 4}, {2, 3}, {2, 4}, {3, 4}};
  EXPECT_EQ(ends, expected);
}

TEST(MeshEdges, KnowTheSidesThatLieOnThem) {
  const Triangles triangles = four_around_the_middle();
  int sides = 0;
  for (const MeshEdge& edge : MeshEdges(triangles)) {
    EXPECT_EQ(edge.size(), edge.high == 4 ? 2u : 1u);
    int before = -1;
    for (const TriangleSide& side : edge) {
      const int from = triangles(side.triangle, (side.corner + 1) % 3),
                to = triangles(side.triangle, (side.corner + 2) % 3);
      EXPECT_EQ(from, side.forwards ? edge.low : edge.high);
      EXPECT_EQ(to, side.forwards ? edge.high : edge.low);
      EXPECT_GT(side.triangle, before);
      before = side.triangle;
      ++sides;
    }
  }
  EXPECT_EQ(sides, 12);
}

TEST(MeshEdges, HaveTheSidesOfAllTrianglesOfAnEdge) {
  Triangles fan(3, 3);
  fan << 0, 1, 2, 1, 0, 3, 0, 1, 4;
  const MeshEdges edges(fan);
  EXPECT_EQ(edges.size(), 7u);
  const MeshEdge& common = *edges.begin();
  ASSERT_EQ(common.size(), 3u);
  EXPECT_TRUE(common[0].forwards);
  EXPECT_FALSE(common[1].forwards);
  EXPECT_TRUE(common[2].forwards);
}

TEST(MeshEdges, BorderRunsWithTheMeshOnItsLeft) {
  const std::vector<std::pair<int, int>> expected{{0, 1}, {3, 0}, {1, 2}, {2, 3}};
  EXPECT_EQ(border_of(MeshEdges(four_around_the_middle())), expected);
}

TEST(MeshEdges, ABorderThatTouchesItselfGoesOnInOrder) {
  Triangles two(2, 3);  // with vertex 2 in common
  two << 2, 3, 4, 0, 1, 2;
  std::vector<int> after;
  for (const auto& [from, to] : border_of(MeshEdges(two)))
    if (from == 2) after.push_back(to);
  EXPECT_EQ(after, (std::vector<int>{0, 3}));
}

TEST(MeshEdges, ThereAreNoneWithoutTriangles) {
  const MeshEdges edges{Triangles(0, 3)};
  EXPECT_EQ(edges.size(), 0u);
  EXPECT_TRUE(border_of(edges).empty());
}

}  // namespace
}  // namespace paperbake
