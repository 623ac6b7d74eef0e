#pragma once

#include "core/model/sheet.h"

#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// Constrained Delaunay triangulation of the region that closed polygons enclose.
/// points  [m] no two of them equal; point i becomes vertex i
/// border  sides of the polygons as pairs of points, in any orientation; a region that lies within
///         an odd number of polygons is triangulated
/// chords  edges inside that the triangulation has to contain
/// returns |T|x3 counter-clockwise; nothing when edges cross each other or pass through points
std::optional<Triangles> constrained_delaunay(const std::vector<Vector2d>& points,
                                              const std::vector<std::pair<int, int>>& border,
                                              const std::vector<std::pair<int, int>>& chords = {});

}  // namespace paperbake
