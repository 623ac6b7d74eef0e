#pragma once

#include "core/model/sheet.h"

#include <functional>
#include <vector>

namespace paperbake {

/// Merges vertices of a flat mesh that are joined by an edge shorter than `shortest`: first the
/// shortest edges. Lines that cross beside each other leave edges of a micrometre, whose lengths
/// the 32-bit positions of a cache cannot hold.
///
/// A vertex is merged with its neighbour, which stays where it is. Points of the border and of
/// other lines move along these lines alone, and not where the lines turn, cross or end; no
/// triangle becomes flatter than the flattest was around the vertex. Edges that these rules forbid
/// to merge remain.
///
/// pattern    |V|x2 [m] of the mesh; the vertices that are left move up
/// triangles  |T|x3 counter-clockwise
/// kept       |V| 1: the vertex is not merged with another, though others may be with it
/// on_line    whether the edge between two vertices lies on a line that has to stay; the border is
///            one without that
/// shortest   [m]
/// returns    for every vertex of before the one that it has become
std::vector<int> merge_short_edges(Points2& pattern, Triangles& triangles,
                                   const std::vector<char>& kept,
                                   const std::function<bool(int, int)>& on_line, double shortest);

}  // namespace paperbake
