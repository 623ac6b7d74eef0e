#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The angle by which a sheet is folded along a line of its pattern; > 0 bulges towards the
/// normals. The mean over the segments of the line, between the triangles on both sides of their
/// middles. [rad]
/// line    [m] polyline
/// beside  [m] how far from it its two sides are seen
double fold_of_line(const Sheet&, const std::vector<Vector2d>& line, double beside);

}  // namespace paperbake
