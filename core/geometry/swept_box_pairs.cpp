#include "core/geometry/swept_box_pairs.h"

#include "core/geometry/mesh_edges.h"

#include <algorithm>
#include <numeric>

namespace paperbake {

SweptBoxPairs::SweptBoxPairs(const Triangles& triangles)
    : triangles_(triangles),
      owned_(triangles.rows()),
      order_(triangles.rows()),
      box_(triangles.rows()) {
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<char> taken(triangles.size() ? triangles.maxCoeff() + 1 : 0, 0);
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      if (!taken[triangles(t, i)]) owned_[t].corners |= 1 << i;
      taken[triangles(t, i)] = 1;
    }
  for (const MeshEdge& e : MeshEdges(triangles)) owned_[e[0].triangle].edges |= 1 << e[0].corner;
}

const std::vector<std::pair<int, int>>& SweptBoxPairs::find(const Points3& x, const Points3& move,
                                                            double margin) {
  pairs_.clear();
  const int n = static_cast<int>(triangles_.rows());
  if (n == 0) return pairs_;
  const Points3 end = x + move;
  const Points3 low = x.cwiseMin(end).array() - margin, high = x.cwiseMax(end).array() + margin;
  for (int t = 0; t < n; ++t) {
    const int* c = &triangles_(t, 0);
    for (int k = 0; k < 3; ++k) {
      box_[t][k] = std::min({low(c[0], k), low(c[1], k), low(c[2], k)});
      box_[t][3 + k] = std::max({high(c[0], k), high(c[1], k), high(c[2], k)});
    }
  }
  int axis;
  (high.colwise().maxCoeff() - low.colwise().minCoeff()).maxCoeff(&axis);
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    return std::make_pair(box_[a][axis], a) < std::make_pair(box_[b][axis], b);
  });
  const int p = (axis + 1) % 3, q = (axis + 2) % 3;
  for (int i = 0; i < n; ++i) {
    const auto& a = box_[order_[i]];
    for (int j = i + 1; j < n; ++j) {
      const auto& b = box_[order_[j]];
      if (b[axis] > a[3 + axis]) break;
      if (b[p] <= a[3 + p] && a[p] <= b[3 + p] && b[q] <= a[3 + q] && a[q] <= b[3 + q])
        pairs_.emplace_back(std::minmax(order_[i], order_[j]));
    }
  }
  return pairs_;
}

}  // namespace paperbake
