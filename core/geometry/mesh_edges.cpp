#include "core/geometry/mesh_edges.h"

#include <algorithm>
#include <tuple>

namespace paperbake {

MeshEdges::MeshEdges(const Triangles& triangles) {
  struct Side {
    int low, high, triangle, corner;
    bool forwards;
  };
  std::vector<Side> sides;
  sides.reserve(triangles.size());
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = triangles(t, (i + 1) % 3), b = triangles(t, (i + 2) % 3);
      sides.push_back({std::min(a, b), std::max(a, b), t, i, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle, a.corner) <
           std::tie(b.low, b.high, b.triangle, b.corner);
  });
  sides_.reserve(sides.size());
  edges_.reserve(sides.size() / 2 + 1);
  for (const Side& side : sides) {
    sides_.push_back({side.triangle, side.corner, side.forwards});
    const TriangleSide* const here = &sides_.back();
    if (edges_.empty() || edges_.back().low != side.low || edges_.back().high != side.high)
      edges_.push_back({side.low, side.high, here, here});
    edges_.back().last = here + 1;
  }
}

std::vector<std::pair<int, int>> border_of(const MeshEdges& edges) {
  std::vector<std::pair<int, int>> border;
  for (const MeshEdge& edge : edges)
    if (edge.size() == 1)
      border.emplace_back(edge[0].forwards ? std::pair(edge.low, edge.high)
                                           : std::pair(edge.high, edge.low));
  return border;
}

}  // namespace paperbake
