#include "core/render/strain_limit.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

StrainLimit::StrainLimit(const Points2& pattern, const Triangles& triangles,
                         const StrainLimitOptions& options)
    : options_(options) {
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(3 * triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      pairs.push_back(std::minmax(triangles(t, i), triangles(t, (i + 1) % 3)));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  start_.assign(pattern.rows() + 1, 0);
  for (const auto& [a, b] : pairs) {
    edges_.push_back({a, b, (pattern.row(a) - pattern.row(b)).norm()});
    ++start_[a + 1];
    ++start_[b + 1];
  }
  for (std::size_t v = 1; v < start_.size(); ++v) start_[v] += start_[v - 1];
  of_vertex_.resize(2 * edges_.size());
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    of_vertex_[next[edges_[e].a]++] = static_cast<int>(e);
    of_vertex_[next[edges_[e].b]++] = static_cast<int>(e);
  }
}

void StrainLimit::operator()(Points3& x, const std::vector<char>& held) const {
  const double longest = 1 + options_.limit, shortest = 1 - options_.limit;
  const auto beyond = [&](int e) {
    const double square = (x.row(edges_[e].a) - x.row(edges_[e].b)).squaredNorm(),
                 rest = edges_[e].rest * edges_[e].rest;
    return square > rest * longest * longest || square < rest * shortest * shortest;
  };
  std::vector<int> now, next;
  std::vector<char> queued(edges_.size(), 0);
  for (std::size_t e = 0; e < edges_.size(); ++e)
    if (beyond(static_cast<int>(e))) now.push_back(static_cast<int>(e));
  for (int sweep = 0; sweep < options_.sweeps && !now.empty(); ++sweep) {
    next.clear();
    for (const int e : now) {
      queued[e] = 0;
      if (!beyond(e)) continue;
      const auto [a, b, rest] = edges_[e];
      const double share_a = held[a]   ? 0.0
                             : held[b] ? 1.0
                                       : 0.5,
                   share_b = held[b]   ? 0.0
                             : held[a] ? 1.0
                                       : 0.5;
      const Eigen::RowVector3d d = x.row(b) - x.row(a);
      const double length = std::max(d.norm(), 1e-3 * rest),
                   aim = std::clamp(length, rest * shortest, rest * longest);
      const Eigen::RowVector3d move = (1 - aim / length) * d;
      x.row(a) += share_a * move;
      x.row(b) -= share_b * move;
      for (const int v : {a, b})
        for (int k = start_[v]; k < start_[v + 1]; ++k)
          if (!queued[of_vertex_[k]]) {
            queued[of_vertex_[k]] = 1;
            next.push_back(of_vertex_[k]);
          }
    }
    std::sort(next.begin(), next.end());
    now.swap(next);
  }
}

double StrainLimit::worst(const Points3& x) const {
  double worst = 0;
  for (const Edge& e : edges_)
    worst = std::max(worst, std::abs((x.row(e.a) - x.row(e.b)).norm() / e.rest - 1));
  return worst;
}

}  // namespace paperbake
