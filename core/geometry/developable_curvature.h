#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Curvature tensor of the sheet at each vertex, in pattern coordinates, taking for granted that it
/// does not stretch: what its triangles tell, by least squares,
///
///   S_t = sum_i theta_i l_i/A_i n_i (x) n_i  +  c n_b (x) n_b,     S_v minimises sum_t area_t |S_v
///   - S_t|^2
///
/// theta_i the dihedral angle, l_i the length and n_i the unit normal of an edge in the pattern,
/// A_i the area of its two triangles. A border edge b has no angle: c is such that det S_t = 0
/// where the two folds bulge to one side, as paper that does not stretch has it, and 0 where they
/// do not; exact on the strips between rulings and on zigzags. Being a guess, that part of S_v -
/// S_t counts only 1/20: where other triangles of the ring know it, they tell; where none does, the
/// neighbours that know. It finds rulings where the mesh has other edges, which vertex_curvature
/// (curvature.h) does not on strips; but it must not be asked whether a sheet bends in two
/// directions.
/// returns  |V|x3 [1/m]  Sxx, Sxy, Syy
Points3 developable_curvature(const Sheet&);

}  // namespace paperbake
