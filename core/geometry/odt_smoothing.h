#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// One step of optimal-Delaunay smoothing of the free points: each goes to the area-weighted mean
/// of the circumcentres round it; where that would leave its triangles' hull the mean of their
/// centroids serves. To be triangulated anew after it.
/// points  [m] the first `fixed` of them stay
/// source  [Chen 2004]
void smooth_points(const Triangles&, std::vector<Vector2d>& points, int fixed);

}  // namespace paperbake
