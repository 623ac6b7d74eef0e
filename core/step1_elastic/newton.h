#pragma once

#include "core/step1_elastic/colliders.h"
#include "core/step1_elastic/contact.h"
#include "core/step1_elastic/elastic_energy.h"
#include "core/step1_elastic/handle_springs.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace paperbake {

/// The incremental potential of one step over all vertices; held ones are left out by whoever solves.
///
///   W(x) = sum_i m_i/2 inertia |x_i - xhat_i|^2 + E(x) + sum_i m_i g z_i + springs of handles + barrier of contact + colliders
struct IncrementalPotential {
  const ElasticEnergy& elastic;
  const Eigen::VectorXd& mass;  // [kg] of the vertices
  Points3 xhat;
  double inertia;               // [1/s2] factor on the mass
  double gravity;
  const std::vector<HandleSpring>& springs;
  Contact* contact;             // null: the sheet does not feel itself
  ColliderContact* colliders = nullptr;  // null: there are none

  double operator()(const Points3& x) const {
    double value = elastic.energy(x) + inertia_and_weight(x);
    if (!springs.empty()) value += energy(springs, x);
    if (contact) value += contact->energy(x);
    if (colliders) value += colliders->energy(x);
    return value;
  }

  double inertia_and_weight(const Points3& x) const {
    return mass.dot(0.5 * inertia * (x - xhat).rowwise().squaredNorm() + gravity * x.col(2));
  }

  void add_inertia_and_weight(const Points3& x, Points3& gradient) const {
    for (int v = 0; v < x.rows(); ++v)
      gradient.row(v) += mass[v] * (inertia * (x.row(v) - xhat.row(v)) + gravity * Eigen::RowVector3d::UnitZ());
  }

  /// Value; gradient |V|x3 overwritten; second derivative into the matrix.
  double differentiate(const Points3& x, const std::vector<int>& block_of, HessianForm form, Points3& gradient,
                       BlockCholesky& matrix, const MembraneStress* stress = nullptr) const {
    matrix.set_zero();
    double value = elastic.hessian(x, form, gradient, matrix, stress) + inertia_and_weight(x);
    add_inertia_and_weight(x, gradient);
    if (!springs.empty()) value += paperbake::differentiate(springs, x, block_of, gradient, matrix);
    if (contact) value += contact->differentiate(x, gradient, &matrix);
    if (colliders) value += colliders->differentiate(x, block_of, gradient, &matrix);
    for (int v = 0; v < x.rows(); ++v)
      matrix.add(matrix.slot(block_of[v], block_of[v]), Matrix3(mass[v] * inertia * Matrix3::Identity()));
    return value;
  }
};

/// What Newton's method works on.
struct NewtonSystem {
  const IncrementalPotential& W;
  BlockCholesky& matrix;             // of the free vertices, bound to all parts of W
  const std::vector<int>& block_of;  // |V| block row, -1: held
  double mean_edge;                  // [m]
  double membrane_stiffness;         // [N/m]
};

struct NewtonOptions {
  double stop;                       // [m] it ends when no vertex is farther than this from the minimum, as far as it can tell
  int max_iterations;                // [1] factorisations
  int max_strides = std::min(25, 2 * max_iterations / 3);  // [1] of them on the first way: the rest is for the one that gets there
  enum Ways { both, stride, descend } ways = both;
  std::function<bool(const Points3&)> in_vain = nullptr;  // asked now and then on the last way: true ends it
};

struct NewtonReport {
  int iterations = 0;
  bool converged = false;
  bool descended = false;            // the second way was taken
  bool in_vain = false;              // it was given up
};

/// Moves x to a minimum of W near by. Two ways, the second where the first does not arrive:
///
/// 1. The stress of the membrane is an unknown of its own, eliminated triangle by triangle: the stress in the second derivative
///    is the one that the last step predicted, not the one that its quadratic error in length pretends. Paper is so stiff in its
///    plane that plain Newton can only creep along the isometric shapes; this one strides, up and down in W. [Magisano 2017]
/// 2. Downhill only: the exact second derivative (projected where it is not positive definite), a backtracking line search.
///
/// With contact only the second way is taken, and no iteration passes through anything.
/// stress  of the membrane where x came from
/// throws  Error(Fault::simulation) when W is not finite
NewtonReport minimise(const NewtonSystem&, const NewtonOptions&, const MembraneStress& stress, Points3& x);

}  // namespace paperbake
