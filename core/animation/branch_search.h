#pragma once

#include "core/step1_elastic/elastic.h"

#include <cstdint>
#include <string>

namespace paperbake {

/// Result of a search for other branches, with the handles where they are.
struct BranchSearch {
  double before = 0, after = 0;  // [J] potential of the sheet before and after the search
  bool taken = false;            // another branch is more than 2 % lower: the sheet is on it now
  // no other branch: the sheet touches itself, was not at its minimum yet and is lower now
  bool finished = false;
  // another shape has the same energy within 2 %, for example a mirror image
  bool equal = false;
};

struct BranchSearchOptions {
  double dt;           // [s] of a frame
  std::uint32_t seed;  // of the sheet
  int frame;
  int waves_of_each = 3;  // number of waves of each height
};

/// Looks for other minima of the potential. The sheet is displaced along its normals by long waves
/// that depend on seed and frame: waves_of_each with an RMS height of 2 % of its longer side, and
/// as many with 6 %. Each displaced sheet is relaxed with the handles where they are. The lowest
/// result that is a minimum, does not intersect itself and is more than 2 % below the sheet as it
/// is, is taken: an elastic step leads to it, so that the sheet yields and touches as in any step.
/// Otherwise the search leaves no trace.
///
/// A sheet that touches itself cannot be displaced without passing through itself. It is given up
/// to twelve more steps to come lower on its own branch.
///
/// source  this project
BranchSearch probe_branches(Sheet&, Elastic&, const StepInput&, const BranchSearchOptions&);

/// What the certificate says about it; empty: nothing.
std::string note_of(const BranchSearch&);

}  // namespace paperbake
