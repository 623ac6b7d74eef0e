#pragma once

#include "core/step1_elastic/contact/collider_contact.h"
#include "core/step1_elastic/contact/sheet_contact.h"
#include "core/step1_elastic/energies/air_drag.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "core/step1_elastic/energies/external_forces.h"
#include "core/step1_elastic/energies/handle_springs.h"

#include <vector>

namespace paperbake {

/// The potential that a step of one sheet minimises, without self-contact. The solver eliminates
/// the constrained vertices.
///
///   W(x) = E(x) + sum_i m_i (inertia/2 |x_i - xhat_i|^2 + phi(x_i)) + handle springs
///          + air + colliders
///
/// phi  potential of the external forces per unit of mass (external_forces.h)
struct SheetPotential {
  const ElasticEnergy& elastic;
  const Eigen::VectorXd& mass;       // [kg] of the vertices
  const std::vector<int>& block_of;  // |V| block row in the matrix, -1: constrained
  Points3 xhat = {};
  double inertia = 0;  // [1/s2] factor on the mass
  ExternalForces forces = {};
  PositionConstraints springs = {};      // constraints that pull (handle_springs.h)
  ColliderContact* colliders = nullptr;  // null: there are none
  const AirDrag* air = nullptr;          // null: there is none

  /// The same step of a sheet that stores another energy.
  SheetPotential with(const ElasticEnergy& stored) const {
    return {stored, mass, block_of, xhat, inertia, forces, springs, colliders, air};
  }
  double energy_and_springs(const Points3& x) const;
  double inertia_and_forces(const Points3& x) const {
    return mass.dot(0.5 * inertia * (x - xhat).rowwise().squaredNorm() + forces.potential(x));
  }
  /// The value without colliders, and its derivatives; gradient |V|x3 is overwritten.
  double differentiate(const Points3& x, HessianForm, Points3& gradient, BlockCholesky&,
                       const MembraneStress*) const;
};

/// The incremental potential of a step: of one sheet, or the sum over several sheets, whose
/// vertices stand one after the other, with one contact for all.
struct IncrementalPotential {
  std::vector<SheetPotential> sheets;
  SheetContact* contact;  // null: no self-contact

  double operator()(const Points3& x) const;

  /// Returns the value; gradient |V|x3 is overwritten, and so is the matrix, with the Hessian.
  /// stress  membrane stress of the only sheet, in place of that at x; null: the stress at x
  double differentiate(const Points3& x, HessianForm, Points3& gradient, BlockCholesky&,
                       const MembraneStress* stress = nullptr) const;

  /// Shortens a move so that it is collision-free. returns the fraction that is left
  double limit_step(const Points3& x, Points3& move) const;

 private:
  template <class Visit>
  void for_each_sheet(const Points3& x, Visit) const;
};

}  // namespace paperbake
