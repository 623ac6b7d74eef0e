#include "formats/maps/fold_width.h"

#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/model/segment2.h"
#include "core/render/curved_surface.h"

#include <cmath>

namespace paperbake {
namespace {

/// For each vertex the area of its one-ring, and how far that reaches from the vertex in both
/// directions of a line.
struct OneRings {
  Eigen::VectorXd area;
  Eigen::Array<double, Eigen::Dynamic, 2>
      reach;  // [m] 0 where the line leaves the sheet at the vertex
};
OneRings one_rings_along(const Sheet& sheet, const Points2& line) {
  const Eigen::Index vertices = sheet.pattern.rows();
  OneRings rings{Eigen::VectorXd::Zero(vertices),
                 Eigen::Array<double, Eigen::Dynamic, 2>::Zero(vertices, 2)};
  for (Eigen::Index t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int v = sheet.triangles(t, i);
      const Vector2d p = sheet.pattern.row(sheet.triangles(t, (i + 1) % 3)) - sheet.pattern.row(v);
      const Vector2d q = sheet.pattern.row(sheet.triangles(t, (i + 2) % 3)) - sheet.pattern.row(v);
      // the tolerance puts a line along an edge into both triangles
      const double doubled = cross(p, q), rounding = -1e-6 * std::sqrt(std::abs(doubled));
      rings.area[v] += 0.5 * doubled;
      for (const int side : {0, 1}) {
        const Vector2d along = (side == 0 ? 1.0 : -1.0) * line.row(v).transpose();
        const double left = cross(p, along), right = cross(along, q);
        if (left < rounding || right < rounding || left + right <= 0) continue;
        rings.reach(v, side) = std::max(rings.reach(v, side), doubled / (left + right));
      }
    }
  return rings;
}

}  // namespace

Eigen::VectorXd fold_widths(const Sheet& sheet, const Points3& curvature, double fold_width) {
  const Eigen::Index vertices = sheet.pattern.rows();
  Eigen::VectorXd folded = Eigen::VectorXd::Zero(vertices), creased = folded;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const auto& v = hinge.vertices;
    const double turn = dihedral_angle(sheet.x, hinge),
                 size = std::abs(turn) * (sheet.pattern.row(v[1]) - sheet.pattern.row(v[0])).norm();
    for (int k = 0; k < 4; ++k) {
      const double share = k < 2 ? 1.0 : 0.5;  // as in core/geometry/curvature
      folded[v[k]] += share * size;
      creased[v[k]] += share * size * crease_share(turn);
    }
  }
  Points2 line(vertices, 2);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    const Vector2d across = principal_curvature(curvature.row(v)).across;
    line.row(v) << -across.y(), across.x();
  }
  const OneRings rings = one_rings_along(sheet, line);
  Eigen::VectorXd width = Eigen::VectorXd::Constant(vertices, fold_width);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    const double length = rings.reach.row(v).sum();
    if (creased[v] <= 0 || length <= 0) continue;
    const double share = creased[v] / folded[v];
    width[v] += share * (rings.area[v] / length - fold_width);
  }
  return width;
}

Points3 fold_tensors(const Points3& curvature, const Eigen::VectorXd& width) {
  Points3 folds = width.asDiagonal() * curvature;
  for (Eigen::Index v = 0; v < folds.rows(); ++v) {
    const double largest = std::abs(larger_principal(folds(v, 0), folds(v, 1), folds(v, 2)));
    if (largest > max_fold_angle) folds.row(v) *= max_fold_angle / largest;
  }
  return folds;
}

}  // namespace paperbake
