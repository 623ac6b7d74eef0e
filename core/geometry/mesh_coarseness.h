#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Mean square of the dihedral angles, weighted by the bending energy that each of them stores.
/// [rad2]
double mean_square_fold(const Sheet&);

// [rad2] Folds of 10 degrees: eighteen of them make a half turn. On a coarser mesh bends that
// travel hook on the edges, and a step may not converge.
constexpr double fold_that_hooks = 0.03;
// [rad2] Folds of 20 degrees: a sheet that lies on such a mesh is held back for certain.
constexpr double fold_that_holds = 0.12;

}  // namespace paperbake
