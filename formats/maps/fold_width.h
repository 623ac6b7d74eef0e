#pragma once

#include "core/model/sheet.h"

#include <Eigen/Core>

namespace paperbake {

/// No fold turns farther than shut, either way. [rad]
inline constexpr double max_fold_angle = 3.14159265358979323846;

/// Across what width the curvature of each vertex counts as one fold, so that curvature x width is
/// an angle:
///
///   w_v = (1 - s_v) w + s_v A_v / L_v
///
/// w    rolled paper turns by its curvature times this, whatever the mesh
/// A/L  a mesh folds sharply in a line, and core/curvature spreads that over the one-ring of a
///      vertex: area A_v, length L_v along its ruling. Curvature times A/L is the dihedral angle
///      again, however coarse the mesh is there; within an eighth on a mesh whose inner vertices
///      lie a fifth of an edge off, and the sum of the angles where several creases cross the ring
/// s_v  [0, 1] how much of what folds in the ring is a crease (crease_share of core/curved_surface,
///      weighted by length x angle)
///
/// curvature   |V|x3 [1/m], of core/curvature
/// fold_width  w [m]
/// returns     |V| [m]
Eigen::VectorXd fold_widths(const Sheet&, const Points3& curvature, double fold_width);

/// Curvature x width, and none of its principal values beyond `shut`. |V|x3 [rad] Fxx, Fxy, Fyy
Points3 fold_tensors(const Points3& curvature, const Eigen::VectorXd& width);

/// Principal value of larger magnitude of (Sxx, Sxy, Syy).
double larger_principal(double xx, double xy, double yy);

}  // namespace paperbake
