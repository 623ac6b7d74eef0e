#pragma once

#include "core/step1_elastic/solver/incremental_potential.h"
#include "core/step1_elastic/solver/solver_limits.h"

#include <functional>
#include <vector>

namespace paperbake {

/// The system that Newton's method solves.
struct NewtonSystem {
  const IncrementalPotential& W;
  BlockCholesky& matrix;             // of the free vertices, bound to all parts of W
  const std::vector<int>& block_of;  // |V| block row of each vertex, -1: constrained
  double mean_edge;                  // [m]
  double membrane_stiffness;         // [N/m]
};

/// When a minimisation stops, and which variants of Newton's method it may use.
struct NewtonOptions {
  // [m] it stops when every vertex is estimated to be within this distance of the minimum
  double stop;
  int max_iterations;  // [1]
  // [1] of these, at most so many by mixed Newton: the rest is for line-search Newton
  int max_mixed_newton = mixed_newton_limit(max_iterations);
  enum Ways { both, mixed_newton, line_search_newton } ways = both;
  // asked every few iterations of the last variant that is allowed: true ends the minimisation
  std::function<bool(const Points3&)> should_abort = nullptr;
};

/// How a minimisation went.
struct NewtonReport {
  int iterations = 0;
  bool converged = false;
  bool descended = false;  // line-search Newton was used
  bool aborted = false;    // should_abort ended it
};

/// Moves x to a nearby minimum of W by Newton's method, in two variants; the second is used where
/// the first does not converge:
///
/// 1. Mixed Newton. The stress of the membrane is an unknown of its own, eliminated triangle by
///    triangle: the Hessian contains the stress that the last iteration predicted to first order,
///    not the spurious stress that comes from its quadratic error in length. Paper is so stiff in
///    its plane that plain Newton can only creep along the isometric shapes; this variant takes
///    long steps, on which W may rise and fall. [Magisano 2017]
/// 2. Line-search Newton. W only decreases: the exact Hessian (projected where it is not positive
///    definite) and a backtracking line search.
///
/// With contact only the second variant is used, and no iteration passes through anything.
/// stress  of the membrane where x came from; empty for several sheets, which are always in contact
/// throws  EnergyNotFinite when W is not
NewtonReport minimise(const NewtonSystem&, const NewtonOptions&, const MembraneStress& stress,
                      Points3& x);

}  // namespace paperbake
