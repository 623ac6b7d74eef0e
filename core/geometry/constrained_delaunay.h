#pragma once

#include "core/model/sheet.h"

#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// Delaunay triangulation of what closed polygons enclose, as far as given edges allow.
/// points  no two of them equal; each is a vertex of the same number
/// border  the sides of the polygons, any way round; what lies within an odd number of them is
///         triangulated
/// chords  edges inside
/// returns |T|x3 counter-clockwise; nothing when edges cross each other or pass through points
std::optional<Triangles> constrained_delaunay(const std::vector<Vector2d>& points,
                                              const std::vector<std::pair<int, int>>& border,
                                              const std::vector<std::pair<int, int>>& chords = {});

}  // namespace paperbake
