#pragma once

#include "core/step1_elastic/elastic.h"

#include <cstdint>
#include <string>

namespace paperbake {

/// What a probe for other shapes found, with the handles where they are.
struct BranchSearch {
  double before = 0, after = 0;  // [J] potential of the sheet as it was, and as it is now
  bool taken = false;            // another branch is more than 2 % lower: the sheet is on it now
  // no other branch: the sheet touches itself and was not yet at its minimum
  bool finished = false;
  // another shape has the same energy within 2 %, as a mirror image has
  bool equal = false;
};

/// Looks for other minima of the potential. The sheet is pushed along its normals by long waves
/// that depend on seed and frame, some (three) of 2 % of its longer side and some of 6 %, and every
/// one is relaxed with the handles where they are. The lowest that ends at a minimum, does not
/// cross itself and is more than 2 % below the sheet as it is, is taken: stepped to, so that it
/// flows and touches as in any step. Otherwise there is no trace of the probe. A sheet that touches
/// itself cannot be pushed, not through itself: it is given twelve more steps to get lower where it
/// is.
/// dt      [s] of a frame
/// source  this project
BranchSearch probe_branches(Sheet&, Elastic&, const PositionConstraints&, double dt,
                            std::uint32_t seed, int frame, int waves_of_each = 3);

/// What there is to say of it in the certificate; empty: nothing.
std::string note_of(const BranchSearch&);

}  // namespace paperbake
