#include "core/render/strain_limit.h"

#include "core/geometry/mesh_edges.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

StrainLimit::StrainLimit(const Points2& pattern, const Triangles& triangles,
                         const StrainLimitOptions& options)
    : options_(options) {
  start_.assign(pattern.rows() + 1, 0);
  for (const MeshEdge& e : MeshEdges(triangles)) {
    edges_.push_back({e.low, e.high, (pattern.row(e.low) - pattern.row(e.high)).norm()});
    ++start_[e.low + 1];
    ++start_[e.high + 1];
  }
  for (std::size_t v = 1; v < start_.size(); ++v) start_[v] += start_[v - 1];
  of_vertex_.resize(2 * edges_.size());
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    of_vertex_[next[edges_[e].a]++] = static_cast<int>(e);
    of_vertex_[next[edges_[e].b]++] = static_cast<int>(e);
  }
}

bool StrainLimit::is_beyond(double limit, std::size_t edge, const Points3& x) const {
  const auto& [a, b, length] = edges_[edge];
  const double square = (x.row(a) - x.row(b)).squaredNorm(), rest = length * length;
  return square > rest * (1 + limit) * (1 + limit) || square < rest * (1 - limit) * (1 - limit);
}

std::vector<int> StrainLimit::beyond(double limit, const Points3& x) const {
  std::vector<int> edges;
  for (std::size_t e = 0; e < edges_.size(); ++e)
    if (is_beyond(limit, e, x)) edges.push_back(static_cast<int>(e));
  return edges;
}

void StrainLimit::operator()(Points3& x, const std::vector<char>& held) const {
  limit_to(options_.limit, beyond(options_.limit, x), x, held);
  for (const double aim : options_.aims) {
    std::vector<int> edges = beyond(aim, x);
    if (static_cast<double>(edges.size()) > options_.few * static_cast<double>(edges_.size()))
      return;
    if (edges.empty()) continue;
    const Points3 before = x;
    if (!limit_to(aim, std::move(edges), x, held) &&
        worst(x) > std::max(options_.limit, worst(before)))
      x = before;
  }
}

bool StrainLimit::limit_to(double limit, std::vector<int> now, Points3& x,
                           const std::vector<char>& held) const {
  const double longest = 1 + limit, shortest = 1 - limit;
  std::vector<int> next;
  std::vector<char> queued(edges_.size(), 0);
  for (int sweep = 0; sweep < options_.sweeps && !now.empty(); ++sweep) {
    next.clear();
    for (const int e : now) {
      queued[e] = 0;
      if (!is_beyond(limit, e, x)) continue;
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
  return now.empty();
}

double StrainLimit::worst(const Points3& x) const {
  double worst = 0;
  for (const Edge& e : edges_)
    worst = std::max(worst, std::abs((x.row(e.a) - x.row(e.b)).norm() / e.rest - 1));
  return worst;
}

}  // namespace paperbake
