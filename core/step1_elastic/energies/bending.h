#pragma once

#include "core/geometry/hinges.h"
#include "core/model/paper.h"
#include "core/model/sheet.h"

#include <array>
#include <limits>

namespace paperbake {

/// Dihedral angle of a hinge and its gradient. source [Bridson 2003]
struct DihedralAngle {
  double theta;                       // [rad]
  Eigen::Matrix<double, 4, 3> slope;  // [1/m] row k: d theta / d x_k
};
DihedralAngle dihedral_angle_gradient(const Points3& x, const Hinge&);

/// Contribution of one wing of a hinge to the Hessian of its dihedral angle, with respect to the
/// edge e = x1 - x0 and the arm a = wing - x0; `ae` is the transpose of `ea`. The contributions of
/// the two wings add up to d2 theta exactly, and each lives on the corners of its own triangle: the
/// matrix of a sheet needs no block between the two wings for it.
/// left  true if the wing lies on the left of x0 -> x1
struct DihedralHessian {
  Matrix3d ee, ea, aa;  // [1/m2]
};
DihedralHessian dihedral_hessian_of_wing(const Vector3d& e, const Vector3d& a, bool left);

/// Bending of one triangle, from its shape operator, so that the material does not change with the
/// mesh.
///
///   S = G (sum_i theta_i l_i/A_i n_i n_i^T) G,   S' = S - Sp
///   E = D/2 A ( nu (tr S')^2 + (1-nu) |S'|^2 )
///     = 1/2 theta^T K theta - b^T theta + c
///
/// theta_i, l_i, n_i  dihedral angle, pattern length, pattern normal of the edge opposite corner i
/// A_i                area of the two triangles that share it: the angle is spread evenly over both
/// Sp                 plastic curvature: G Sp0 G, where Sp0 is what is stored
/// G                  r^(1/8) along the grain of the paper and r^(-1/8) across it, r = D_MD/D_CD;
///                    the identity for paper without a grain. This makes the plate orthotropic:
///                    D r^(1/2) and D r^(-1/2), with Huber's twisting stiffness (1-nu) D
///
/// A border edge has no dihedral angle. The part of S that only this edge could determine, n n^T,
/// is left out: no moment crosses a free border. (With that part kept, triangles along the border
/// store 1/12 too much energy; the arch of 232 triangles is off by 3 % instead of 0.3 %. With each
/// angle given half to one side and half to the other, irregular meshes are 6 % too stiff instead
/// of 3 %.) What a triangle cannot determine of S is not taken from Sp either.
/// source  [Grinspun 2006] for the operator; [Huber 1923] for the twist; the two rules are this
///         project's
struct RestBending {
  Matrix3d stiffness;                 // [J] K, zero rows for border edges
  Eigen::Matrix3d operator_of_theta;  // [1/m] columns: l_i/A_i (n_x^2, n_x n_y, n_y^2)
  double area;                        // [m2]
  double rigidity;                    // [N m] D of this triangle
  double poisson;
  double hardening;  // [1] eta
  // from Sp0 to the part of Sp that the three angles can determine, with G on both sides; the
  // identity inside a sheet without a grain
  Eigen::Matrix3d seen;
  Eigen::Matrix3d kept;  // from S to Sp0: the inverse of G on both sides
};
/// shared_area  [m2] A_i; 0: border
/// stiffening   [1] factor on D (for the finger-sized disc of a handle)
RestBending rest_bending(const Paper&, const Points2& pattern, const Eigen::RowVector3i& corners,
                         const std::array<double, 3>& shared_area, double stiffening);

/// Plastic state of a triangle at the beginning of a step.
struct PlasticState {
  Vector3d curvature{0, 0, 0};  // [1/m] Sp: Sxx, Sxy, Syy
  // [1/m] q_y = k_y/m + eta/(1-eta) alpha, where m is the curvature concentration of ridge_yield.h;
  // infinite: elastic
  double yield = std::numeric_limits<double>::infinity();
};

/// Bending energy of one triangle and the moments on its three dihedral angles, with the yielding
/// of this step inside: linear hardening by radial return, independent of the rate.
///
///   q = sqrt(nu (tr S')^2 + (1-nu) |S'|^2)     the curvature itself when S' is a cylinder
///   E = D A psi(q),   psi = q^2/2 up to q_y,   q_y^2/2 + q_y (q - q_y) + eta (q - q_y)^2/2 beyond
///
/// theta    [rad] dihedral angles of its hinges, 0 on the border
/// moment   [J] dE/dtheta, overwritten; may be null
/// tangent  [J] d2E/dtheta2, overwritten; never indefinite; may be null
/// returns  [J]
double bending_energy(const RestBending&, const Vector3d& theta, const PlasticState& = {},
                      Vector3d* moment = nullptr, Matrix3d* tangent = nullptr);

/// [J m] Derivative of bending_energy with respect to sum_i theta_i l_i/A_i n_i n_i^T, the shape
/// operator of a triangle without grain inside the sheet. Symmetric.
Eigen::Matrix2d bending_moment_tensor(const RestBending&, const Vector3d& theta,
                                      const PlasticState&);

/// Plastic increment of a triangle that is left in this shape:
///
///   Sp += S' (1 - q_el/q),   alpha += q - q_el,   q_el = q_y + eta (q - q_y);   zero below yield
///
/// As alpha grows, the yield curvature rises to q_el, so that a step may be divided.
struct PlasticGain {
  Vector3d curvature{0, 0, 0};  // [1/m]
  double hardening = 0;         // [1/m]
};
PlasticGain plastic_gain(const RestBending&, const Vector3d& theta, const PlasticState&);

}  // namespace paperbake
