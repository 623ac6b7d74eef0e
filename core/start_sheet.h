#pragma once

#include "core/animate.h"

#include <vector>

namespace paperbake {

/// Factor on the bending stiffness of each triangle of a mesh of the sheet, the first (start_sheet) or a later one: more inside the
/// discs of handles. |T|
std::vector<double> disc_factors(const Sheet&, const Shot&);

}  // namespace paperbake
