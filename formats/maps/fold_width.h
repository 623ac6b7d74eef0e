#pragma once

#include "core/geometry/hinges.h"
#include "core/model/sheet.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <vector>

namespace paperbake {

/// [rad] a fold cannot turn farther than this in either direction: it is shut then
inline constexpr double max_fold_angle = M_PI;

/// The width by which the curvature at each vertex has to be multiplied to give the turn of the
/// smooth paper there across a width w:
///
///   w_v = (1 - s_v) w
///
/// s_v  [0, 1] fraction of the folding in the one-ring that is due to creases (crease_share of
///      core/render/curved_surface, weighted by length x angle): core/geometry/curvature spreads a
///      crease over the one-rings of its ends, whose size is that of the mesh. Creases are
///      sharp_folds().
///
/// fold_width  w [m]
/// returns     |V| [m]
Eigen::VectorXd fold_widths(const Sheet&, const Hinges&, double fold_width);

/// An edge of the mesh that is a crease in this frame.
struct SharpFold {
  int hinge;  // of find_hinges()
  std::array<int, 2> ends;
  double angle;        // [rad] crease_share x dihedral angle: it fades in as the paper is folded
  double plastic = 0;  // [rad] of that, what the paper keeps; 0 without plasticity
};
/// curvature  |V|x3 [1/m], of core/geometry/curvature
/// plastic    |V|x3 [1/m] of that, or empty for none. Both are spread over the same one-rings, so
///            that the paper keeps as much of the angle as of the curvature across the edge
std::vector<SharpFold> sharp_folds(const Sheet&, const Hinges&, const Points3& curvature,
                                   const Points3& plastic);

/// [rad] The turn of a sheet across one fold width where it turns smoothly by the first and on a
/// crease by the second.
template <class Real>
Real larger_turn(Real smooth, Real sharp) {
  return std::abs(sharp) > std::abs(smooth) ? sharp : smooth;
}

/// Tensors of fold angles at the vertices: curvature x width, scaled down where a principal value
/// exceeds `max_fold_angle`. |V|x3 [rad] Fxx, Fxy, Fyy
Points3 fold_tensors(const Points3& curvature, const Eigen::VectorXd& width);

/// The eigenvalue of larger magnitude of the symmetric tensor (Sxx, Sxy, Syy).
template <class Real>
Real larger_principal(Real xx, Real xy, Real yy) {
  const Real half = Real(0.5), mean = half * (xx + yy), half_difference = half * (xx - yy);
  const Real radius = std::sqrt(half_difference * half_difference + xy * xy);
  return mean + std::copysign(radius, mean + Real(0));  // -0 counts as 0
}

}  // namespace paperbake
