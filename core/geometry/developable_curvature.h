#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Curvature tensor of the sheet at each vertex, in pattern coordinates, on the assumption that the
/// sheet does not stretch. It is the least-squares fit to the tensors of the triangles around the
/// vertex:
///
///   S_t = sum_i theta_i l_i/A_i n_i (x) n_i  +  c n_b (x) n_b,
///   S_v minimises sum_t area_t |S_v - S_t|^2
///
/// where theta_i is the dihedral angle, l_i the length and n_i the unit normal of an edge in the
/// pattern, and A_i the area of its two triangles. A border edge b has no dihedral angle. Where the
/// two other edges of the triangle bulge to the same side, c is chosen such that det S_t = 0, as in
/// paper that does not stretch; where they do not, c = 0. This is exact on the strips between
/// rulings and on zigzags. Because it is a guess, that part of S_v - S_t has a weight of only 1/20:
/// where other triangles of the ring determine it, they decide; where none does, the neighbouring
/// vertices that know it decide.
///
/// This finds rulings that do not run along edges of the mesh, which vertex_curvature (curvature.h)
/// does not find on strips. It must not be used to decide whether a sheet bends in two directions.
/// returns  |V|x3 [1/m]  Sxx, Sxy, Syy
Points3 developable_curvature(const Sheet&);

}  // namespace paperbake
