#pragma once

#include "core/model/sheet.h"

#include <Eigen/Core>

#include <cmath>

namespace paperbake {

/// [rad] a fold cannot turn farther than this in either direction: it is shut then
inline constexpr double max_fold_angle = 3.14159265358979323846;

/// The width by which the curvature at each vertex has to be multiplied to give the angle of a
/// fold:
///
///   w_v = (1 - s_v) w + s_v A_v / L_v
///
/// w    for rolled paper: the angle is the turn across this width, whatever the mesh
/// A/L  for a crease: a mesh folds sharply along a line, and core/geometry/curvature spreads that
///      over the one-ring of a vertex, which has area A_v and length L_v along the ruling there.
///      Curvature times A/L gives the dihedral angle back, however coarse the mesh is: within an
///      eighth on a mesh whose inner vertices are displaced by a fifth of an edge, and the sum of
///      the angles where several creases cross the ring
/// s_v  [0, 1] fraction of the folding in the ring that is due to creases (crease_share of
///      core/render/curved_surface, weighted by length x angle)
///
/// curvature   |V|x3 [1/m], of core/geometry/curvature
/// fold_width  w [m]
/// returns     |V| [m]
Eigen::VectorXd fold_widths(const Sheet&, const Points3& curvature, double fold_width);

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
