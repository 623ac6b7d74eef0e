#pragma once

#include "core/step1_elastic/contact/collider_contact.h"
#include "core/step1_elastic/contact/self_contact.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "core/step1_elastic/energies/handle_springs.h"

#include <vector>

namespace paperbake {

/// What a step of one sheet is the minimum of, without contact; held vertices are left out by
/// whoever solves.
///
///   W(x) = sum_i m_i/2 inertia |x_i - xhat_i|^2 + E(x) + sum_i m_i g z_i + springs of handles +
///   colliders
struct SheetPotential {
  const ElasticEnergy& elastic;
  const Eigen::VectorXd& mass;  // [kg] of the vertices
  Points3 xhat;
  double inertia;  // [1/s2] factor on the mass
  double gravity;
  std::vector<HandleSpring> springs;
  ColliderContact* colliders;        // null: there are none
  const std::vector<int>& block_of;  // |V| block row in the matrix, -1: held

  double energy_and_springs(const Points3& x) const;
  double inertia_and_weight(const Points3& x) const {
    return mass.dot(0.5 * inertia * (x - xhat).rowwise().squaredNorm() + gravity * x.col(2));
  }
  /// The value but for colliders; its derivatives, gradient |V|x3 overwritten.
  double differentiate(const Points3& x, HessianForm, Points3& gradient, BlockCholesky&,
                       const MembraneStress*) const;
};

/// The incremental potential of a step: of one sheet, or the sum over several, whose vertices stand
/// one after the other, and one contact for all.
struct IncrementalPotential {
  std::vector<SheetPotential> sheets;
  Contact* contact;  // null: nothing is felt

  double operator()(const Points3& x) const;

  /// Value; gradient |V|x3 overwritten; second derivative into the matrix.
  /// stress  of the membrane of the one sheet there is, in place of that at x; null: that at x
  double differentiate(const Points3& x, HessianForm, Points3& gradient, BlockCholesky&,
                       const MembraneStress* stress = nullptr) const;

  /// Cuts a move where something meets. returns the share that is left
  double limit_step(const Points3& x, Points3& move) const;

 private:
  template <class Visit>
  void for_each_sheet(const Points3& x, Visit) const;
};

}  // namespace paperbake
