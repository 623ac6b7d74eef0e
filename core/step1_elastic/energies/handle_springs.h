#pragma once

#include "core/linear_algebra/block_cholesky.h"
#include "core/model/sheet.h"
#include "core/step1_elastic/contact/self_contact.h"
#include "core/step1_elastic/elastic.h"

#include <vector>

namespace paperbake {

/// What pulls a sheet point to where its handle is.
///
///   phi(r) = k r^2/2 up to the yield force F0 = k r0,   F0 (r - r0) + k_y (r - r0)^2/2 + k r0^2/2
///   beyond
///
/// k   [N/m] a soft handle's own stiffness; of a hard one so much that r is a few microns as long
///     as the paper follows
/// F0  [N]   infinite for a soft handle
/// k_y [N/m] of a hard handle that the paper cannot follow
/// source  this project; force and stiffness measured on crumpled sheets
struct HandleSpring {
  int vertex;
  Vector3d target;     // [m]
  double stiffness;    // k
  double yield_force;  // F0
};

/// The spring of a soft handle, or of a hard one on a sheet that touches itself.
HandleSpring soft_spring(int vertex, const Vector3d& target, double stiffness);
HandleSpring yielding_spring(int vertex, const Vector3d& target);

/// Those of the handles that are hard.
HardConstraints hard_handles(const PositionConstraints&);

/// Springs of the soft handles and, on a sheet that touches itself or is jammed, of the hard ones.
enum class HardHandles { are_held, may_yield };
std::vector<HandleSpring> handle_springs(const PositionConstraints&, HardHandles);

/// The spring pulls with more than its yield force.
bool yields(const HandleSpring&, const Points3& x);

double energy(const std::vector<HandleSpring>&, const Points3& x);  // [J]
/// The energy; its derivative is added to the gradient and its second derivative, never indefinite,
/// to the matrix.
double differentiate(const std::vector<HandleSpring>&, const Points3& x,
                     const std::vector<int>& block_of, Points3& gradient, BlockCholesky&);

}  // namespace paperbake
