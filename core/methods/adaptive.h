#pragma once

#include "core/methods/adaptive_mesh/sizing_field.h"
#include "core/methods/method.h"

namespace paperbake {

/// Adaptive remeshing: step 1 on a mesh whose edges are split, flipped and collapsed until their
/// lengths follow a sizing field (adaptive_mesh/sizing_field.h). Before every elastic step the
/// sheet is measured as the last step left it, and one pass brings its mesh closer to the field, at
/// most twice as fine; the elastic step then relaxes the sheet, so that remeshing does not show as
/// a jump. The first mesh is coarse.
///
/// An edge is split where its metric length is above 1, and collapsed only if that gives edges
/// shorter than 0.8: a sheet at rest keeps its mesh. Every change costs iterations, so a pass waits
/// until 1 % of the edges are too long, or one of them by a quarter. A sheet that did not reach its
/// minimum keeps its mesh. One whose handles are about to jump by more than a tenth of its longer
/// side is coarsened first, because a jump is followed in up to 32 steps. Fields that ask for more
/// than `max_triangles` are coarsened as a whole.
///
/// The plastic curvature lies on a grid of the pattern that is independent of the mesh
/// (plastic_grid.h): rest angles are read from it after every change, and nothing has to be carried
/// from face to face.
/// source  [Narain 2012], [Narain 2013]
MethodChoice adaptive(const Pattern&, int max_triangles, const SizingOptions& = {});

}  // namespace paperbake
