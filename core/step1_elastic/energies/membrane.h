#pragma once

#include "core/geometry/rest_triangle.h"
#include "core/model/paper.h"

namespace paperbake {

using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// The exact Hessian, or a near one without negative eigenvalues that is cheap to compute.
enum class HessianForm { exact, projected };

/// Where membrane_energy adds the Hessian, and which.
struct MembraneHessian {
  Matrix9& sum;  // [N/m] d2W/dx2 is added to it, corner by corner
  HessianForm form = HessianForm::exact;
  // 2x2 [N/m] taken for S (below) in the geometric part; null: S itself
  const Eigen::Matrix2d* stress = nullptr;
};

/// Stretching energy of one triangle: constant strain, St. Venant-Kirchhoff, plane stress.
///
///   F = sum_i x_i g_i^T,   G = (F^T F - I)/2,   S = lambda (tr G) I + 2 mu G,   W = A/2 S:G
///   lambda = Eh nu/(1-nu^2),  mu = Eh/(2(1+nu))
///
/// x          3x3 [m]    row i: position of corner i
/// gradient   3x3 [N]    dW/dx is added to it; may be null
/// hessian    may be null
/// returns        [J]
/// source     [Volino 2009]; the projected form keeps only the tensile part of the stress in the
///            geometric term
double membrane_energy(const Paper&, const RestTriangle&, const Matrix3d& x,
                       Matrix3d* gradient = nullptr, const MembraneHessian* hessian = nullptr);

/// 2x2 [N/m] S at x + move, to first order in move (second Piola-Kirchhoff).
Eigen::Matrix2d membrane_stress(const Paper&, const RestTriangle&, const Matrix3d& x,
                                const Matrix3d& move);

}  // namespace paperbake
