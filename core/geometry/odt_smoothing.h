#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// One step of optimal-Delaunay smoothing of the free points: each moves to the area-weighted mean
/// of the circumcentres of its triangles or, where that could leave the hull of these triangles, to
/// the mean of their centroids. The points have to be triangulated again afterwards.
/// points  [m] changed in place; the first `fixed` of them stay
/// source  [Chen 2004]
void smooth_points(const Triangles&, std::vector<Vector2d>& points, int fixed);

}  // namespace paperbake
