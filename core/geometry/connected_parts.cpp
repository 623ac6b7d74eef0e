#include "core/geometry/connected_parts.h"

#include <algorithm>
#include <numeric>

namespace paperbake {

std::vector<int> connected_parts(const Triangles& triangles, Eigen::Index vertices) {
  std::vector<int> lowest(vertices);
  std::iota(lowest.begin(), lowest.end(), 0);
  const auto part_of = [&](int v) {
    while (lowest[v] != v) v = lowest[v] = lowest[lowest[v]];
    return v;
  };
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 1; i < 3; ++i) {
      const int a = part_of(triangles(t, 0)), b = part_of(triangles(t, i));
      lowest[std::max(a, b)] = std::min(a, b);
    }
  for (int v = 0; v < vertices; ++v) lowest[v] = part_of(v);
  return lowest;
}

}  // namespace paperbake
