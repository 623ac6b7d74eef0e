#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// How small triangles should be.
struct SizingOptions {
  double edge_turn = 0.25;     // [rad] by which the sheet may turn along an edge
  double largest = 0.25;       // [1]   longest edge, of the square root of the area
  double smallest = 1 / 64.0;  // [1]   shortest edge, of the longer side: a plastic cell
  double aspect = 6;           // [1]   longest edge over shortest edge at one point
  double growth = 2;           // [1]   size at one end of an edge over the size at the other
  // [rad] rotation of the lattice of the first mesh (pattern_mesh.h); no result should depend on it
  double turn = 0;
};

/// Sizing field: a metric M on the pattern for each vertex (edge_operations.h).
///
///   M = S^2 / edge_turn^2  v  Sp^2 / edge_turn^2
///
/// S   curvature tensor (developable_curvature.h): an edge turns by no more than edge_turn
/// Sp  plastic curvature: a crease that was flattened keeps its triangles
/// v   the coarsest metric that is at least as fine as both
///
/// There are no terms for compression and for the gradient of S. A sheet at rest is hardly
/// compressed where its mesh can buckle, and the compression that is left is the error of a coarse
/// mesh: refined for the wave in which it would buckle, S1 takes 377 triangles instead of 215, and
/// a flat sheet under compression is refined without end. With the gradient S1 and S8 have as many
/// triangles and a larger error (0.27 instead of 0.18 %, 0.38 instead of 0.31 %).
///
/// Sizes lie within [smallest, largest], and at one point within `aspect`; from vertex to vertex
/// they grow by no more than `growth`.
/// kept     |V|x3 [1/m] Sxx, Sxy, Syy of Sp; empty: none
/// side     [m] longer side of the pattern
/// returns  |V|x3 [1/m2] Mxx, Mxy, Myy
/// source   [Narain 2012], section 3
Points3 sizing_field(const Sheet&, const Points3& kept, double side, const SizingOptions&);

/// About how many triangles a mesh has whose edges follow the field.
double triangles_of(const Sheet&, const Points3& metric);

}  // namespace paperbake
