#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Flips edges of the mesh towards the rulings. Of the two diagonals of a convex pair of triangles
/// the one with the smaller sagitta d^T M d stays, where M is the mean over the four corners of
/// |S| + 0.3/m I; where the sheet is flat, that is the shorter one. Which diagonals are rejected is
/// said at flip_edges (edge_operations.h); the least share of a triangle is 8 %.
/// curvature  |V|x3 [1/m] Sxx, Sxy, Syy of the vertices
/// gain       [1] the new diagonal must have less than this fraction of the old one's sagitta
/// returns    number of edges flipped, in at most 6 passes
int flip_towards_rulings(Sheet&, const Points3& curvature, double gain);

}  // namespace paperbake
