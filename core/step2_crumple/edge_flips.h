#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Turns the edges of the mesh towards the rulings: of the two diagonals of a convex pair of
/// triangles the one with the smaller sagitta d^T M d stays, M = mean over the four corners of |S|
/// + 0.3/m I; where the sheet is flat, the shorter one. A diagonal that would compress the sheet by
/// more than 3 % or fold it by more than 2.2 rad is not taken, nor one with a triangle of less than
/// 8 % of the pair, nor one that would pass through another part of the sheet or end next to it.
/// curvature  |V|x3 [1/m] of the vertices
/// gain       [1] the new diagonal must have less than this share of the old one's sagitta
/// returns    how many edges turned, in at most 6 passes
int flip_towards_rulings(Sheet&, const Points3& curvature, double gain);

}  // namespace paperbake
