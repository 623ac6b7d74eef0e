#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Operations on single edges of a sheet, in rounds of edges that share no triangle, so that their
/// order does not matter much. The mesh stays one of the same pattern: border, holes and the first
/// `fixed` vertices as they are, every triangle the right side up. A sheet passes through nothing
/// when its mesh changes: splits leave its surface as it is; flips and collapses that would sweep
/// over another part of it are left out.
///
/// metric  |V|x3 [1/m2] of the vertices (sizing_field.h); it follows the vertices
/// source  [Narain 2012], section 4; the criterion of flips [Bossen 1996]

/// How far a mesh is from its field.
struct Misfit {
  double longest = 0;   // [1] edge in the metric
  double too_long = 0;  // [1] share of the edges that are longer than 1
};
Misfit misfit(const Sheet&, const Points3& metric);

/// One round: edges longer than 1, the longest first, get a vertex in their middle (positions and
/// velocities between those of the ends), as long as there are no more than `max_triangles`.
/// returns  how many
int split_long_edges(Sheet&, Points3& metric, int max_triangles);

/// Edges turn until, measured in the mean metric of its four corners, no two opposite angles are
/// more than a straight one by a margin; in at most 6 rounds. An edge that would compress the sheet
/// by more than 3 % or fold it by more than 2.2 rad stays.
/// returns  how many turned
int flip_to_delaunay(Sheet&, const Points3& metric);

/// One round: a vertex is drawn to a neighbour, the nearest pairs first, when all edges that come
/// of it are shorter than `longest` and no triangle is much worse than the worst was before; border
/// vertices along straight border. Vertices behind those that are gone move up.
/// returns  how many are gone
int collapse_short_edges(Sheet&, Points3& metric, int fixed, double longest);

}  // namespace paperbake
