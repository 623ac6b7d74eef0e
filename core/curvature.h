#pragma once

#include "core/sheet.h"

#include <vector>

namespace paperbake {

/// Curvature tensor of the sheet at each vertex, in pattern coordinates: what its triangles tell, by least squares,
///
///   S_t = sum_i theta_i l_i/A_i n_i (x) n_i  +  c n_b (x) n_b,     S_v minimises sum_t area_t |S_v - S_t|^2
///
/// theta_i the dihedral angle, l_i the length and n_i the unit normal of an edge in the pattern, A_i the area of its two
/// triangles. A border edge b has no angle: c is such that det S_t = 0 where the two folds bulge to one side, as paper that does
/// not stretch has it, and 0 where they do not; exact on the strips between rulings and on zigzags. Being a guess, that part of
/// S_v - S_t counts only 1/20: where other triangles of the ring know it, they tell; where none does, the neighbours that know.
/// A sheet that bulges towards its normal (counter-clockwise side) has positive curvature.
/// returns  |V|x3 [1/m]  Sxx, Sxy, Syy
Points3 vertex_curvature(const Sheet&);

/// Principal curvatures of one such tensor, |k1| >= |k2|, and the direction across which the sheet bends most.
struct Principal {
  double k1, k2;       // [1/m]
  Vector2d across;     // unit, pattern; the ruling is perpendicular to it
};
Principal principal_curvature(const Vector3d& tensor);

/// How far each vertex turns in its second direction.
struct SecondTurn {
  std::vector<char> border;     // the vertex lies on the border
  std::vector<double> area;     // A_v [m2] a third of the triangles round it
  std::vector<double> turn;     // |k2| sqrt(A_v) [rad]
};
/// curvature  |V|x3 [1/m] of the vertices
SecondTurn second_turn(const Sheet&, const Points3& curvature);

}  // namespace paperbake
