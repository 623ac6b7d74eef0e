#pragma once

#include "core/geometry/hinges.h"
#include "core/model/sheet.h"

#include <cmath>
#include <functional>
#include <vector>

namespace paperbake {

/// Operations on single edges of a sheet. They work in rounds of edges that share no triangle, so
/// that their order hardly matters. The mesh remains one of the same pattern: border and holes stay
/// as they are, and no triangle is turned over. A sheet passes through nothing when its mesh
/// changes: splits leave the surface as it is, and flips and collapses that would sweep over
/// another part of the sheet are left out.
///
/// metric  |V|x3 [1/m2] Mxx, Mxy, Myy of the vertices: an edge d has the right length when
///         d^T M d = 1. It changes with the vertices
/// source  [Narain 2012], section 4; [Bossen 1996] for the criterion of flips

/// Length of an edge in the mean metric of its ends; 1: as it should be.
double metric_length(const Sheet&, const Points3& metric, int a, int b);

/// How far a mesh is from its sizing field.
struct Misfit {
  double longest = 0;   // [1] longest edge, in the metric
  double too_long = 0;  // [1] share of the edges longer than 1 in the metric
};
Misfit misfit(const Sheet&, const Points3& metric);

/// One round of splits: edges longer than 1 in the metric, the longest first, get a vertex in their
/// middle (position and velocity are the means of those of the ends), as long as there are no more
/// than `max_triangles`.
/// returns  the number of splits
int split_long_edges(Sheet&, Points3& metric, int max_triangles);

/// Flips edges that want to be flipped, in at most 6 rounds. An edge stays if it is on a prescribed
/// crease, if one of the new triangles would have less than `least_share` [1] of the area of both,
/// if the new edge would compress the sheet by more than 3 % or fold it by more than 2.2 rad, or if
/// it would pass through another part of the sheet or come close to it.
/// returns  the number of flips
int flip_edges(Sheet&, double least_share, const std::function<bool(const Hinge&)>& wants);

/// Flips edges until, in the mean metric of the four corners, the two angles opposite an edge add
/// up to no more than pi, with a margin. An edge at which the sheet folds by more than `max_fold`
/// [rad] stays.
/// returns  the number of flips
int flip_to_delaunay(Sheet&, const Points3& metric, double max_fold = M_PI);

/// One round of collapses: a vertex is merged with a neighbour, the nearest pairs first, if all
/// edges that result are shorter than `longest` and no triangle is much worse than the worst was
/// before. Border vertices move along straight border only. Vertices behind those that are removed
/// move up.
/// kept     |V| 1: the vertex is not removed
/// returns  the number of vertices removed
int collapse_short_edges(Sheet&, Points3& metric, const std::vector<char>& kept, double longest);

}  // namespace paperbake
