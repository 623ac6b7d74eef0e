#pragma once

#include "core/methods/method.h"
#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// The first mesh with the start shape on it. A flat start gets a ripple of 1e-6 m along its normal
/// that depends on the seed, not on the mesh. Singular points that are kept are born in the first
/// frame.
struct InitialSheet {
  Sheet sheet;
  std::vector<int> handle_vertex;  // of each handle
  // |V| vertices that handles and the rims of their discs need where they are
  std::vector<char> fixed;
  std::vector<double> stiffening;  // |T| factor on bending: 10 inside the discs of handles
};
InitialSheet make_initial_sheet(const Shot&, const Method&, unsigned seed, int first_frame = 1);

/// Factor on the bending stiffness of each triangle of a mesh of the sheet, the first
/// (make_initial_sheet) or a later one: more inside the discs of handles. |T|
std::vector<double> disc_factors(const Sheet&, const Shot&);

}  // namespace paperbake
