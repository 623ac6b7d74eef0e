#include "core/geometry/swept_box_pairs.h"

#include "core/geometry/mesh_edges.h"
#include "tests/core/test_meshes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace paperbake {
namespace {

using Pairs = std::set<std::pair<int, int>>;

Points3 noise(Eigen::Index rows, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Points3 x(rows, 3);
  for (Eigen::Index k = 0; k < x.size(); ++k) x.data()[k] = uniform(random);
  return x;
}

Pairs pairs_one_by_one(const Triangles& triangles, const Points3& x, const Points3& move,
                       double margin) {
  std::vector<Eigen::AlignedBox3d> boxes(triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t) {
    for (const int v : {triangles(t, 0), triangles(t, 1), triangles(t, 2)}) {
      boxes[t].extend(x.row(v).transpose());
      boxes[t].extend((x.row(v) + move.row(v)).transpose());
    }
    boxes[t].min().array() -= margin;
    boxes[t].max().array() += margin;
  }
  Pairs pairs;
  for (int a = 0; a < triangles.rows(); ++a)
    for (int b = a + 1; b < triangles.rows(); ++b)
      if (boxes[a].intersects(boxes[b])) pairs.emplace(a, b);
  return pairs;
}

TEST(SweptBoxPairsTest, FindsThePairsWhoseBoxesOverlapAndNoOthersTimeAndAgain) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 8, 0.1);
  SweptBoxPairs broad_phase(sheet.triangles);
  // along other axes and after other moves: what an earlier sweep has left must not matter
  for (unsigned seed = 0; seed < 6; ++seed) {
    Points3 x = sheet.x + noise(sheet.x.rows(), 0.02, seed);
    x.col(seed % 3) *= 3;
    const Points3 move = noise(x.rows(), 0.01 * seed, seed + 100);
    const auto& found = broad_phase.find(x, move, 1e-3);
    EXPECT_EQ(Pairs(found.begin(), found.end()), pairs_one_by_one(sheet.triangles, x, move, 1e-3));
    EXPECT_EQ(Pairs(found.begin(), found.end()).size(), found.size()) << "each once";
  }
}

TEST(SweptBoxPairsTest, AMoveFindsWhatStandsInItsWay) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 4, 0);
  const int n = static_cast<int>(sheet.triangles.rows());
  const Eigen::Index rows = sheet.x.rows();
  Triangles both(2 * n, 3);
  both << sheet.triangles, sheet.triangles.array() + static_cast<int>(rows);
  Points3 x(2 * rows, 3), move = Points3::Zero(2 * rows, 3);
  x << sheet.x, sheet.x;
  x.bottomRows(rows).col(2).array() += 0.05;
  const auto between = [&](const auto& pairs) {
    return std::count_if(pairs.begin(), pairs.end(),
                         [&](const auto& pair) { return pair.first < n && pair.second >= n; });
  };
  SweptBoxPairs broad_phase(both);
  EXPECT_EQ(between(broad_phase.find(x, move, 1e-3)), 0);
  move.bottomRows(rows).col(2).array() = -0.1;  // to the other side
  EXPECT_GE(between(broad_phase.find(x, move, 1e-3)), n);
}

TEST(SweptBoxPairsTest, OneTriangleIsResponsibleForEachVertexAndEachEdge) {
  const Sheet sheet = test::hex_sheet(0.1, 0.07, 6, 0.1);
  const SweptBoxPairs broad_phase(sheet.triangles);
  std::map<int, int> of_vertex;
  std::map<std::pair<int, int>, int> of_edge;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int p = sheet.triangles(t, (i + 1) % 3), q = sheet.triangles(t, (i + 2) % 3);
      of_vertex[sheet.triangles(t, i)] += broad_phase.owned()[t].corners >> i & 1;
      of_edge[std::minmax(p, q)] += broad_phase.owned()[t].edges >> i & 1;
    }
  EXPECT_EQ(of_vertex.size(), static_cast<std::size_t>(sheet.x.rows()));
  EXPECT_EQ(of_edge.size(), MeshEdges(sheet.triangles).size());
  for (const auto& [v, owners] : of_vertex) EXPECT_EQ(owners, 1) << "vertex " << v;
  for (const auto& [edge, owners] : of_edge)
    EXPECT_EQ(owners, 1) << "edge " << edge.first << "-" << edge.second;
}

}  // namespace
}  // namespace paperbake
