#pragma once

#include "core/geometry/collider_gap.h"
#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/pattern.h"
#include "core/model/plastic_grid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

// [rad] in a row of triangles: a sheet that turns by more is folded more sharply than its mesh
// shows
constexpr double unresolved_turn = 1;

/// A mesh with what shows that its paper yields: the triangles that have yielded, or the colliders
/// that press the sheet.
struct BentMesh {
  const Sheet& sheet;
  PlasticMemory memory{0};
  Hinges hinges = find_hinges(sheet.triangles);
  double row = mean_edge(sheet.pattern, sheet.triangles);  // [m]
  // |T| [m] curvature times area, plastic or that of the sheet
  std::vector<Eigen::Matrix2d> turn{};
  std::vector<char> counts{};                     // |T| whether a line may run through the triangle
  std::vector<std::optional<ColliderGap>> gap{};  // of each hinge; empty: colliders do not matter

  Vector2d corner(int t, int i) const { return sheet.pattern.row(sheet.triangles(t, i)); }
  Vector2d middle(int t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3; }
  double area(int t) const { return pattern_area(sheet, t); }
  /// [m] Plastic curvature times area.
  Eigen::Matrix2d plastic(int t) const {
    return area(t) * symmetric_matrix(memory.curvature.row(t));
  }
  /// Whether the turn of a hinge belongs to a fold.
  bool counts_hinge(std::size_t h) const { return gap.empty() || gap[h]; }
};

/// A mesh that folds where triangles have yielded.
BentMesh yielded_mesh(const Sheet&, const PlasticMemory&);

/// A mesh that folds where it turns by 1 rad or more in a row of triangles, between colliders that
/// are `widest` [m] apart or less.
BentMesh pressed_mesh(const Sheet&, const ColliderShapes&, double widest);

/// The line about which triangles turn.
struct TurnAxis {
  Vector2d middle{0, 0}, across;  // [m]; of length 1
  double share;                   // [1] of their turn that is about it
  Vector2d along() const { return {-across.y(), across.x()}; }
  double distance(const Vector2d& p) const { return std::abs(across.dot(p - middle)); }  // [m]
};

/// The mean line about which these triangles turn, each weighted by how much it does.
TurnAxis axis_of(const BentMesh&, const std::vector<int>& triangles);

/// The triangles that count within a row of the line.
std::vector<int> band_along(const BentMesh&, const TurnAxis&);

/// The part of the line on paper that its middle lies on.
std::optional<std::pair<Vector2d, Vector2d>> on_paper(const Pattern&, const TurnAxis&);

/// Calls visit(point on the pattern [m], distance from the axis [rows], with its sign, turn about
/// the axis [m rad], number of the hinge) for points of the edges within `reach` rows of the axis.
template <class Visit>
void for_each_turn_within(double reach, const BentMesh& mesh, const TurnAxis& axis, Visit visit) {
  constexpr int samples = 5;  // of an edge
  for (std::size_t h = 0; h < mesh.hinges.hinges.size(); ++h) {
    const Hinge& hinge = mesh.hinges.hinges[h];
    const Vector2d p = mesh.sheet.pattern.row(hinge.vertices[0]),
                   d = mesh.sheet.pattern.row(hinge.vertices[1]).transpose() - p;
    if (std::min(axis.distance(p), axis.distance(p + d)) > (reach + 1) * mesh.row) continue;
    const double turn =
        dihedral_angle(mesh.sheet.x, hinge) * std::pow(d.dot(axis.along()), 2) / d.norm() / samples;
    for (int i = 0; i < samples; ++i) {
      const Vector2d at = p + (i + 0.5) / samples * d;
      const double rows = axis.across.dot(at - axis.middle) / mesh.row;
      if (std::abs(rows) <= reach) visit(at, rows, turn, h);
    }
  }
}

/// The same within a row and a half, for the edges that belong to a fold.
template <class Visit>
void for_each_turn(const BentMesh& mesh, const TurnAxis& axis, Visit visit) {
  for_each_turn_within(1.5, mesh, axis,
                       [&](const Vector2d& at, double rows, double turn, std::size_t h) {
                         if (mesh.counts_hinge(h)) visit(at, rows, turn, h);
                       });
}

}  // namespace paperbake
