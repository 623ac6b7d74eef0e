#pragma once

#include "core/geometry/vertex_rings.h"
#include "core/model/sheet.h"

namespace paperbake {

/// Moves an inner vertex to p on the pattern, or as far towards it as its ring allows: all the way,
/// half of it or a quarter. In space it goes where that place of the sheet was, so that the sheet
/// keeps its shape but for what the edges at the vertex cut off. A move is allowed if
///
/// - p lies in the triangles around the vertex, and none of them becomes thin: its height stays at
///   least a quarter of its longest edge, or no smaller a share than the worst of the ring had;
/// - no edge becomes more than 2 % shorter in space than on the pattern, as one that cuts across a
///   fold would;
/// - the sheet passes through nothing (tetrahedron_is_empty).
///
/// returns  [1] the part of the way that the vertex went; 0: it stayed
double move_vertex(Sheet&, const VertexRings&, int vertex, const Vector2d& p);

}  // namespace paperbake
