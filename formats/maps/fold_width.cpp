#include "formats/maps/fold_width.h"

#include "core/render/curved_surface.h"
#include "formats/maps/pattern_edge.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

Eigen::VectorXd fold_widths(const Sheet& sheet, const Hinges& hinges, double fold_width) {
  const Eigen::Index vertices = sheet.pattern.rows();
  Eigen::VectorXd folded = Eigen::VectorXd::Zero(vertices), creased = folded;
  for (const Hinge& hinge : hinges.hinges) {
    const auto& v = hinge.vertices;
    const double turn = dihedral_angle(sheet.x, hinge),
                 size = std::abs(turn) * (sheet.pattern.row(v[1]) - sheet.pattern.row(v[0])).norm();
    for (int k = 0; k < 4; ++k) {
      const double share = k < 2 ? 1.0 : 0.5;  // as in core/geometry/curvature
      folded[v[k]] += share * size;
      creased[v[k]] += share * size * crease_share(turn);
    }
  }
  Eigen::VectorXd width = Eigen::VectorXd::Constant(vertices, fold_width);
  for (Eigen::Index v = 0; v < vertices; ++v)
    if (creased[v] > 0) width[v] *= 1 - creased[v] / folded[v];
  return width;
}

std::vector<SharpFold> sharp_folds(const Sheet& sheet, const Hinges& all, const Points3& curvature,
                                   const Points3& plastic) {
  const std::vector<Hinge>& hinges = all.hinges;
  std::vector<SharpFold> folds;
  for (std::size_t h = 0; h < hinges.size(); ++h) {
    const auto& v = hinges[h].vertices;
    const double turn = dihedral_angle(sheet.x, hinges[h]), share = crease_share(turn);
    if (share == 0) continue;
    SharpFold fold{static_cast<int>(h), {v[0], v[1]}, share * turn};
    if (plastic.rows() > 0) {
      const PatternEdge edge(sheet, hinges[h]);
      const auto turn_of = [&](const Points3& S) {
        return edge.turn_of(0.5 * (S.row(v[0]) + S.row(v[1])));
      };
      const double kept = turn * turn_of(plastic) / turn_of(curvature);
      if (std::isfinite(kept))
        fold.plastic = share * std::clamp(kept, -max_fold_angle, max_fold_angle);
    }
    folds.push_back(fold);
  }
  return folds;
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
