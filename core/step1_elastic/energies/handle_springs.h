#pragma once

#include "core/linear_algebra/block_cholesky.h"
#include "core/model/sheet.h"
#include "core/step1_elastic/contact/self_contact.h"
#include "core/step1_elastic/elastic.h"

#include <vector>

namespace paperbake {

/// The spring that pulls a point of the sheet to its handle.
///
///   phi(r) = k r^2/2 up to the yield force F0 = k r0
///            k r0^2/2 + F0 (r - r0) + k_y (r - r0)^2/2 beyond
///
/// r    [m] distance from the target
/// k    [N/m] of a soft handle its own stiffness; of a hard one so large that r is a few microns as
///      long as the paper follows
/// F0   [N] infinite for a soft handle
/// k_y  [N/m] of a hard handle that the paper cannot follow
/// source  this project; force and stiffness were measured on crumpled sheets
struct HandleSpring {
  int vertex;
  Vector3d target;     // [m]
  double stiffness;    // [N/m] k
  double yield_force;  // [N] F0
};

/// The spring of a soft handle, or of a hard handle on a sheet that touches itself.
HandleSpring soft_spring(int vertex, const Vector3d& target, double stiffness);
HandleSpring yielding_spring(int vertex, const Vector3d& target);

/// The constraints of the hard handles.
HardConstraints hard_handles(const PositionConstraints&);

/// Springs of the soft handles and, on a sheet that touches itself or is jammed, of the hard ones
/// too.
enum class HardHandles { are_held, may_yield };
std::vector<HandleSpring> handle_springs(const PositionConstraints&, HardHandles);

/// True if the spring pulls with more than its yield force.
bool yields(const HandleSpring&, const Points3& x);

double energy(const std::vector<HandleSpring>&, const Points3& x);  // [J]
/// Returns the energy [J]. Adds its gradient [N] to `gradient` and its Hessian [N/m], which is
/// never indefinite, to the matrix.
double differentiate(const std::vector<HandleSpring>&, const Points3& x,
                     const std::vector<int>& block_of, Points3& gradient, BlockCholesky&);

}  // namespace paperbake
