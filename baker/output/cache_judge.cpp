#include "baker/output/cache_judge.h"

#include "baker/output/gates.h"
#include "core/geometry/mesh_edges.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
Points3 as_stored(const Points3& x) { return x.cast<float>().cast<double>(); }

CacheJudge::CacheJudge(const Points2& uv, const Triangles& triangles, double longer_side,
                       std::shared_ptr<const JudgedColliders> colliders)
    : uv_(uv),
      pattern_(longer_side * uv.cast<float>().cast<double>()),
      triangles_(triangles),
      crossings_(pattern_, triangles),
      colliders_(std::move(colliders)) {
  for (const MeshEdge& e : MeshEdges(triangles))
    edges_.push_back({e.low, e.high, (pattern_.row(e.low) - pattern_.row(e.high)).norm()});
}

bool CacheJudge::is_of(const CacheFrame& frame) const {
  return frame.uv.rows() == uv_.rows() && frame.uv == uv_ &&
         frame.triangles.rows() == triangles_.rows() && frame.triangles == triangles_;
}

int CacheJudge::vertex_at(const Vector2d& p) const {
  Eigen::Index vertex = 0;
  (pattern_.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&vertex);
  return static_cast<int>(vertex);
}

LengthDistortion CacheJudge::distortion(const Points3& x) const {
  LengthDistortion found;
  double sum = 0;
  for (const auto& [a, b, rest] : edges_) {
    const double off = std::abs((x.row(a) - x.row(b)).norm() - rest) / rest;
    sum += off;
    if (off > found.largest) {
      found.largest = off;
      found.where = 0.5 * (pattern_.row(a) + pattern_.row(b));
    }
  }
  found.mean = edges_.empty() ? 0 : sum / static_cast<double>(edges_.size());
  return found;
}

Judgement CacheJudge::operator()(const Points3& positions, int row,
                                 std::optional<int> counted) const {
  const Points3 stored = as_stored(positions);
  Judgement judgement;
  judgement.length = distortion(stored);
  if (!stored.allFinite()) return judgement;  // a cache does not take it
  judgement.crossings = counted ? *counted : crossings_(stored);
  if (!colliders_) return judgement;
  const ColliderPenetration found = colliders_->deepest(row, stored, triangles_);
  if (found.depth <= 0) return judgement;
  judgement.inside = found.depth;
  judgement.inside_of = colliders_->meshes[found.collider].name;
  for (int i = 0; i < 3; ++i)
    judgement.inside_at +=
        found.weights[i] * pattern_.row(triangles_(found.triangle, i)).transpose();
  return judgement;
}

RenderStatistics statistics_of(const Judgement& judgement, const CacheJudge& judge) {
  RenderStatistics statistics;
  statistics.triangles = static_cast<int>(judge.triangles().rows());
  statistics.stretch_mean = judgement.length.mean;
  statistics.stretch_max = judgement.length.largest;
  statistics.crossings = judgement.crossings;
  return statistics;
}

void enter(const Judgement& judgement, FrameRecord& line) {
  line.worst = {judgement.length.where, judgement.inside_at, judgement.inside_of};
  line.statistics.inside = judgement.inside;
  if (judgement.inside > Gates().inside_mm * 1e-3)
    append_note(line.note, fmt::format("inside \"{}\" by {:.2f} mm", judgement.inside_of,
                                       1e3 * judgement.inside));
}

}  // namespace paperbake
