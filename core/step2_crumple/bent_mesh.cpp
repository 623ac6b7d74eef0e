#include "core/step2_crumple/bent_mesh.h"

#include "core/model/segment2.h"

#include <limits>

namespace paperbake {

BentMesh yielded_mesh(const Sheet& sheet, const PlasticMemory& memory) {
  BentMesh mesh{sheet, memory};
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    mesh.turn.push_back(mesh.plastic(t));
    mesh.counts.push_back(!memory.curvature.row(t).isZero(0));
  }
  return mesh;
}

BentMesh pressed_mesh(const Sheet& sheet, const ColliderShapes& colliders, double widest) {
  constexpr double straight = 0.1;  // [rad] edges that turn less do not matter
  BentMesh mesh{sheet};
  const int triangles = static_cast<int>(sheet.triangles.rows());
  mesh.turn.assign(triangles, Eigen::Matrix2d::Zero());
  mesh.counts.assign(triangles, 0);
  for (const Hinge& hinge : mesh.hinges.hinges) {
    const int a = hinge.vertices[0], b = hinge.vertices[1];
    const double turn = dihedral_angle(sheet.x, hinge);
    mesh.gap.emplace_back();
    if (std::abs(turn) < straight) continue;
    mesh.gap.back() = gap_around(colliders, 0.5 * (sheet.x.row(a) + sheet.x.row(b)), widest);
    if (!mesh.gap.back()) continue;
    const Vector2d d = sheet.pattern.row(b) - sheet.pattern.row(a), n(-d.y(), d.x());
    for (const int t : hinge.triangles) mesh.turn[t] += 0.5 * turn / d.norm() * n * n.transpose();
  }
  for (int t = 0; t < triangles; ++t)
    mesh.counts[t] = mesh.turn[t].norm() * mesh.row > unresolved_turn * mesh.area(t);
  return mesh;
}

TurnAxis axis_of(const BentMesh& mesh, const std::vector<int>& triangles) {
  TurnAxis axis;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  double total = 0;
  for (const int t : triangles) {
    const Eigen::Matrix2d& S = mesh.turn[t];
    sum += S;
    total += S.norm();
    axis.middle += S.norm() * mesh.middle(t);
  }
  axis.middle /= total;
  const SymmetricEigen<2> turn = symmetric_eigen(sum);
  const Vector2d size = turn.values.cwiseAbs();
  const int most = size[0] > size[1] ? 0 : 1;
  axis.across = turn.vectors.col(most);
  axis.share = size[most] / total;
  return axis;
}

std::vector<int> band_along(const BentMesh& mesh, const TurnAxis& axis) {
  std::vector<int> band;
  for (int t = 0; t < mesh.sheet.triangles.rows(); ++t)
    if (mesh.counts[t] && axis.distance(mesh.middle(t)) < mesh.row) band.push_back(t);
  return band;
}

std::optional<std::pair<Vector2d, Vector2d>> on_paper(const Pattern& pattern,
                                                      const TurnAxis& axis) {
  const Vector2d along = axis.along();
  constexpr double none = std::numeric_limits<double>::infinity();
  double before = -none, after = none;
  const auto cut = [&](const std::vector<Vector2d>& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d p = polygon[i] - axis.middle,
                     q = polygon[(i + 1) % polygon.size()] - axis.middle;
      const double sp = cross(along, p), sq = cross(along, q);
      if ((sp > 0) == (sq > 0)) continue;
      const double at = along.dot(p + sp / (sp - sq) * (q - p));
      (at > 0 ? after : before) = at > 0 ? std::min(after, at) : std::max(before, at);
    }
  };
  cut(pattern.outline);
  for (const auto& hole : pattern.holes) cut(hole);
  if (before == -none || after == none) return std::nullopt;
  return std::pair{Vector2d(axis.middle + before * along), Vector2d(axis.middle + after * along)};
}

}  // namespace paperbake
