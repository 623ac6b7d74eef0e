#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Mean square of the dihedral angles, weighted by the bending energy that each of them stores.
/// [rad2]
double mean_square_fold(const Sheet&);

/// How far flat triangles are from smooth paper that is bent as they are: an arc that turns by the
/// angle of a fold over the width of the triangles beside it is at most an eighth of the product of
/// both away from its chord (its sagitta). Root of the mean square, weighted by the bending energy
/// that each fold stores. [m]
double rms_sagitta(const Sheet&);

/// The largest dihedral angle, without its sign. [rad]
double sharpest_fold(const Sheet&);

// [rad2] Folds of 3 degrees: the sheet is bent, and not merely rumpled.
constexpr double fold_that_shows = 0.003;
// [rad2] Folds of 10 degrees: eighteen of them make a half turn. On a coarser mesh bends that
// travel hook on the edges, and a step may not converge.
constexpr double fold_that_hooks = 0.03;
// [rad2] Folds of 20 degrees: a sheet that lies on such a mesh is held back for certain.
constexpr double fold_that_holds = 0.12;

// of the number of triangles, for a sheet that stretches where it should bend: edges half as long
constexpr int doublings_to_bend = 2;

}  // namespace paperbake
