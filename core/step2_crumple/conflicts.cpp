#include "core/step2_crumple/conflicts.h"

#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/geometry/prescribed_creases.h"
#include "core/geometry/singular_vertices.h"
#include "core/geometry/vertex_rings.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// For each vertex, the smaller of the largest positive and the largest negative dihedral angle of
/// its edges, as magnitudes. [rad]
std::vector<double> folds_of_both_signs(const Sheet& sheet, const Hinges& hinges) {
  std::vector<double> up(sheet.pattern.rows(), 0.0), down = up;
  for (const Hinge& hinge : hinges.hinges) {
    if (is_on_crease(sheet.prescribed_creases, sheet.pattern, hinge.vertices[0], hinge.vertices[1]))
      continue;
    const double fold = dihedral_angle(sheet.x, hinge);
    for (int k = 0; k < 2; ++k) {
      double& most = (fold > 0 ? up : down)[hinge.vertices[k]];
      most = std::max(most, std::abs(fold));
    }
  }
  for (std::size_t v = 0; v < up.size(); ++v) up[v] = std::min(up[v], down[v]);
  return up;
}

}  // namespace

Conflicts find_conflicts(const Sheet& sheet, const Points3& curvature,
                         const std::vector<char>& fixed, const CrumpleOptions& options) {
  const Hinges hinges = find_hinges(sheet.triangles);
  const SecondTurn second = second_turn(sheet, hinges, curvature);
  const std::vector<char> singular = singular_vertices(sheet);
  std::vector<char> beside(sheet.pattern.rows(), 0);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) beside[sheet.triangles(t, i)] |= singular[sheet.triangles(t, j)];

  const std::vector<double> none(sheet.pattern.rows(), 0.0);
  const std::vector<double> folds = folds_of_both_signs(sheet, hinges);
  Conflicts conflicts{none, std::vector<char>(sheet.pattern.rows(), 0), none,
                      std::vector<char>(sheet.pattern.rows(), 0)};
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (second.border[v] || singular[v] || (v < static_cast<int>(fixed.size()) && fixed[v]))
      continue;
    const Principal p = principal_curvature(curvature.row(v));
    const double turn =
        std::abs(p.k2) > options.conflict_ratio * std::abs(p.k1) ? second.turn[v] : 0;
    conflicts.turn[v] = std::max(turn, folds[v]);
    conflicts.severe[v] =
        turn > options.threshold_near_apex || folds[v] > options.fold_threshold_near_apex;
    conflicts.exceeds[v] =
        conflicts.severe[v] ||
        (!beside[v] && (turn > options.conflict_turn || folds[v] > options.conflict_folds));
    // positive curvature next to a singular point belongs to that point's own cone and would
    // attract the next point
    if (!beside[v] || conflicts.exceeds[v])
      conflicts.core_weight[v] = second.area[v] * std::pow(std::max(0.0, p.k1 * p.k2), 2);
  }
  return conflicts;
}

Vector2d middle_of_conflict(const Sheet& sheet, const Conflicts& conflicts,
                            const std::vector<int>& members) {
  // [1] of the size of its ring: how far from the worst vertex the core of a conflict lies at most;
  // assumed
  constexpr double rings = 1.6;
  Vector2d by_core(0, 0), by_turn(0, 0);
  double core_weight = 0, turn = 0;
  const int worst = *std::max_element(members.begin(), members.end(), [&](int a, int b) {
    return conflicts.turn[a] < conflicts.turn[b];
  });
  const VertexRings around(sheet.triangles, find_hinges(sheet.triangles), sheet.pattern.rows());
  const double reach = rings * ring_size(sheet, around, worst);
  for (int v = 0; v < static_cast<int>(conflicts.core_weight.size()); ++v) {
    if ((sheet.pattern.row(v) - sheet.pattern.row(worst)).norm() > reach) continue;
    by_core += conflicts.core_weight[v] * sheet.pattern.row(v).transpose();
    core_weight += conflicts.core_weight[v];
  }
  if (core_weight > 0) return by_core / core_weight;
  for (const int v : members) {
    by_turn += conflicts.turn[v] * conflicts.turn[v] * sheet.pattern.row(v).transpose();
    turn += conflicts.turn[v] * conflicts.turn[v];
  }
  return by_turn / turn;
}

}  // namespace paperbake
