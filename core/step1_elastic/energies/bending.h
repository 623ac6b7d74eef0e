#pragma once

#include "core/geometry/hinges.h"
#include "core/model/paper.h"
#include "core/model/sheet.h"
#include "core/step1_elastic/energies/membrane.h"

#include <array>
#include <limits>
#include <vector>

namespace paperbake {

/// Dihedral angle of a hinge and its gradient. source [Bridson 2003]
struct DihedralAngle {
  double theta;                       // [rad]
  Eigen::Matrix<double, 4, 3> slope;  // [1/m] row k: d theta / d x_k
};
DihedralAngle dihedral_angle_gradient(const Points3& x, const Hinge&);

/// What one wing of a hinge adds to the second derivative of its angle, by the edge e = x1 - x0 and
/// the arm a = wing - x0; `ae` is the transpose of `ea`. The two wings add up to d2 theta exactly,
/// and each lives on the corners of its own triangle: a sheet needs no block between the two wings
/// for it.
/// left  true when the wing lies on the left of x0 -> x1
struct DihedralHessian {
  Matrix3 ee, ea, aa;  // [1/m2]
};
DihedralHessian dihedral_hessian_of_wing(const Vector3d& e, const Vector3d& a, bool left);

/// Bending of one triangle from its shape operator: the material does not change with the mesh.
///
///   S = G (sum_i theta_i l_i/A_i n_i n_i^T) G,   E = D/2 A ( nu (tr S')^2 + (1-nu) |S'|^2 ),   S'
///   = S - Sp
///     = 1/2 theta^T K theta - b^T theta + c
///
/// theta_i, l_i, n_i  angle, pattern length and pattern normal of the edge opposite corner i
/// A_i                area of the two triangles that share it: the fold is spread evenly over both
/// Sp                 plastic curvature, G Sp0 G where Sp0 is kept
/// G                  of paper with a grain: r^(1/8) along it, r^(-1/8) across, r = D_MD/D_CD; else
///                    the identity. It makes the plate orthotropic: D r^(1/2) and D r^(-1/2), with
///                    Huber's twisting stiffness (1-nu) D
///
/// A border edge has no angle; the part of S that it alone could tell, n n^T, is left out: no
/// moment crosses a free border. (With that part kept, triangles along the border store 1/12 too
/// much; the arch of 232 triangles 3 % instead of 0.3 %. With each fold given to both sides by
/// halves, irregular meshes are 6 % too stiff instead of 3 %.) What a triangle cannot tell of S it
/// does not take from Sp either.
/// source  [Grinspun 2006] for the operator; [Huber 1923] for the twist; the two rules are this
///         project's
struct RestBending {
  Matrix3 stiffness;                  // K [J]  zero rows for border edges
  Eigen::Matrix3d operator_of_theta;  // columns: l_i/A_i (n_x^2, n_x n_y, n_y^2)  [1/m]
  double area;                        // [m2]
  double rigidity;                    // D of this triangle [N m]
  double poisson;
  double hardening;  // eta
  // of Sp0: what the three angles can tell of it, G on both sides; the identity inside a sheet
  // without a grain
  Eigen::Matrix3d seen;
  Eigen::Matrix3d kept;  // from S to Sp0: inverse of G
};
/// shared_area  [m2] A_i; 0: border
/// stiffening   [1]  factor on D (the finger-sized disc of a handle)
RestBending rest_bending(const Paper&, const Points2& pattern, const Eigen::RowVector3i& corners,
                         const std::array<double, 3>& shared_area, double stiffening);

/// What a triangle brings along from its past.
struct PlasticState {
  Vector3d curvature{0, 0, 0};  // Sp [1/m] Sxx, Sxy, Syy
  // q_y [1/m] = k_y/m + eta/(1-eta) alpha, m the focus of ridge_yield.h; infinite: elastic
  double yield = std::numeric_limits<double>::infinity();
};

/// Energy of one triangle and the moments that its three angles feel, with the flow of this step
/// inside: linear hardening by radial return, which does not depend on the rate.
///
///   q = sqrt(nu (tr S')^2 + (1-nu) |S'|^2)     the curvature itself when S' is a cylinder
///   E = D A psi(q),   psi = q^2/2 up to q_y,   q_y^2/2 + q_y (q - q_y) + eta (q - q_y)^2/2 beyond
///
/// theta    [rad] angles of its hinges, 0 on the border
/// moment   dE/dtheta [J], overwritten; may be null
/// tangent  d2E/dtheta2 [J], overwritten; may be null; never indefinite
double bending_energy(const RestBending&, const Vector3d& theta, const PlasticState& = {},
                      Vector3d* moment = nullptr, Matrix3* tangent = nullptr);

/// What a triangle gains when it is left in this shape: Sp += S' (1 - q_el/q), alpha += q - q_el,
/// q_el = q_y + eta (q - q_y); zero below yield. With alpha the yield grows to q_el, so that a step
/// may be cut in pieces.
struct PlasticGain {
  Vector3d curvature{0, 0, 0};  // [1/m]
  double hardening = 0;         // [1/m]
};
PlasticGain plastic_gain(const RestBending&, const Vector3d& theta, const PlasticState&);

}  // namespace paperbake
