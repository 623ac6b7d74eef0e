#pragma once

#include "core/geometry/hinges.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// How far the sheet bends at each hinge of its mesh: the dihedral angle, 0 on a line that was
/// folded before. [rad]
std::vector<double> bending_turns(const Sheet&, const Hinges&);

/// Curvature tensor of the sheet at each vertex, in pattern coordinates, averaged over its
/// one-ring:
///
///   S_v = C^(-1/2) [ sum_spokes theta l n (x) n  +  1/2 sum_link theta l n (x) n ] C^(-1/2) / A,
///   A = area of the one-ring
///
/// theta the dihedral angle, l the length and n the unit normal of an edge in the pattern. C is
/// what the same sum gives for a surface of curvature 1 in all directions: the identity inside a
/// regular mesh, less where the ring is cut by the border, whose edges turn nothing; a direction
/// that a ring sees less than a quarter of is taken from its neighbours. A line that was folded
/// before is no curvature (bending_turns). A sheet that bulges towards its normal
/// (counter-clockwise side) has positive curvature.
/// returns  |V|x3 [1/m]  Sxx, Sxy, Syy
Points3 vertex_curvature(const Sheet&);

/// The same of given turns. turns  [rad] of each hinge of the mesh, in place of bending_turns
Points3 vertex_curvature(const Points2& pattern, const Triangles&, const Hinges&,
                         const std::vector<double>& turns);

/// Principal curvatures of one such tensor, |k1| >= |k2|, and the direction across which the sheet
/// bends most.
struct Principal {
  double k1, k2;    // [1/m]
  Vector2d across;  // unit, pattern; the ruling is perpendicular to it
};
Principal principal_curvature(const Vector3d& tensor);

/// How far each vertex turns in its second direction.
struct SecondTurn {
  std::vector<char> border;  // the vertex lies on the border
  std::vector<double> area;  // A_v [m2] a third of the triangles round it
  std::vector<double> turn;  // |k2| sqrt(A_v) [rad]
};
/// curvature  |V|x3 [1/m] of the vertices; hinges: of the sheet's triangles
SecondTurn second_turn(const Sheet&, const Hinges&, const Points3& curvature);

}  // namespace paperbake
