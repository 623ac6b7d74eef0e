#include "core/geometry/vertex_rings.h"

#include <algorithm>

namespace paperbake {

VertexRings::VertexRings(const Triangles& all, const Hinges& edges, long vertices)
    : triangles(vertices), hinges(vertices), border(vertices, 0) {
  for (int t = 0; t < all.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      triangles[all(t, i)].push_back(t);
      if (edges.of_triangle[t][i] < 0)
        border[all(t, (i + 1) % 3)] = border[all(t, (i + 2) % 3)] = 1;
    }
  for (std::size_t h = 0; h < edges.hinges.size(); ++h)
    for (int end = 0; end < 2; ++end)
      hinges[edges.hinges[h].vertices[end]].push_back(static_cast<int>(h));
}

double ring_size(const Sheet& sheet, const VertexRings& rings, int vertex) {
  double size = 0;
  for (const int t : rings.triangles[vertex])
    for (int i = 0; i < 3; ++i)
      size = std::max(
          size, (sheet.pattern.row(sheet.triangles(t, i)) - sheet.pattern.row(vertex)).norm());
  return size;
}

}  // namespace paperbake
