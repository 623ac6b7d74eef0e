#pragma once

#include "core/linear_algebra/block_cholesky.h"
#include "core/step1_elastic/position_constraints.h"

#include <vector>

namespace paperbake {

/// The springs that pull vertices to their handles: one for each of the given constraints, which
/// are the soft ones and, on a sheet that touches itself or is jammed, the hard ones too.
///
///   phi(r) = k r^2/2 up to F0 = k r0, the force with which a hand holds the paper
///            k r0^2/2 + F0 (r - r0) + k_y (r - r0)^2/2 beyond
///
/// r    [m] distance from the target
/// k    [N/m] of a soft constraint its own stiffness; of a hard one so large that r is a few
///      microns as long as the paper follows
/// F0   [N] infinite for a soft constraint; 3 N for a hard one on copy paper
/// k_y  [N/m] of a hard constraint that the paper cannot follow: 300 N/m on copy paper
///
/// Thinner paper is held by less (grip_on), in all three of them.
///
/// source  this project; force and stiffness were measured on crumpled sheets
double spring_energy(const PositionConstraints&, const Points3& x);  // [J]
/// Returns the energy [J]. Adds its gradient [N] to `gradient` and its Hessian [N/m], which is
/// never indefinite, to the matrix.
double differentiate_springs(const PositionConstraints&, const Points3& x,
                             const std::vector<int>& block_of, Points3& gradient, BlockCholesky&);

/// True if the spring of the constraint pulls with more than F0.
bool gives_way(const PositionConstraint&, const Points3& x);

}  // namespace paperbake
