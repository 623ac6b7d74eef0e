#pragma once

#include "core/step1_elastic/energies/incremental_potential.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace paperbake {

/// What Newton's method works on.
struct NewtonSystem {
  const IncrementalPotential& W;
  BlockCholesky& matrix;             // of the free vertices, bound to all parts of W
  const std::vector<int>& block_of;  // |V| block row of all vertices, -1: held
  double mean_edge;                  // [m]
  double membrane_stiffness;         // [N/m]
};

struct NewtonOptions {
  // [m] it ends when no vertex is farther than this from the minimum, as far as it can tell
  double stop;
  int max_iterations;  // [1] factorisations
  // [1] of them on the first way: the rest is for the one that gets there
  int max_mixed_newton = std::min(25, 2 * max_iterations / 3);
  enum Ways { both, mixed_newton, line_search_newton } ways = both;
  // asked now and then on the last way: true ends it
  std::function<bool(const Points3&)> should_abort = nullptr;
};

struct NewtonReport {
  int iterations = 0;
  bool converged = false;
  bool descended = false;     // the second way was taken
  bool should_abort = false;  // it was given up
};

/// Moves x to a minimum of W near by. Two ways, the second where the first does not arrive:
///
/// 1. The stress of the membrane is an unknown of its own, eliminated triangle by triangle: the
/// stress in the second derivative
///    is the one that the last step predicted, not the one that its quadratic error in length
///    pretends. Paper is so stiff in its
///    plane that plain Newton can only creep along the isometric shapes; this one strides, up and
///    down in W. [Magisano 2017]
/// 2. Downhill only: the exact second derivative (projected where it is not positive definite), a
/// backtracking line search.
///
/// With contact only the second way is taken, and no iteration passes through anything.
/// stress  of the membrane where x came from; of several sheets none, they are always in contact
/// throws  Error(Fault::simulation) when W is not finite
NewtonReport minimise(const NewtonSystem&, const NewtonOptions&, const MembraneStress& stress,
                      Points3& x);

}  // namespace paperbake
