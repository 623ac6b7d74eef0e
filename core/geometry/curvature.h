#pragma once

#include "core/geometry/hinges.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Bending angle of the sheet at each hinge of its mesh: the dihedral angle, but 0 on a prescribed
/// crease. [rad]
std::vector<double> bending_turns(const Sheet&, const Hinges&);

/// Curvature tensor of the sheet at each vertex, in pattern coordinates, averaged over the one-ring
/// of the vertex:
///
///   S_v = C^(-1/2) [ sum_spokes theta l n (x) n  +  1/2 sum_link theta l n (x) n ] C^(-1/2) / A,
///   A = area of the one-ring
///
/// where theta is the dihedral angle, l the length and n the unit normal of an edge in the pattern.
/// C is the value of the same sum for a surface of curvature 1 in all directions: the identity
/// inside a regular mesh, and less where the border cuts the ring, because border edges have no
/// dihedral angle. In a direction of which a ring sees less than a quarter, the curvature of its
/// neighbours is used. A prescribed crease does not count as curvature (bending_turns). A sheet
/// that bulges towards its normal (counter-clockwise side) has positive curvature.
/// returns  |V|x3 [1/m]  Sxx, Sxy, Syy
Points3 vertex_curvature(const Sheet&);

/// The same for given angles. turns  [rad] one for each hinge of the mesh, instead of bending_turns
Points3 vertex_curvature(const Points2& pattern, const Triangles&, const Hinges&,
                         const std::vector<double>& turns);

/// Which vertices away from the border have rings of triangles so obtuse that the tensor says
/// little about how the sheet bends there: C has an eigenvalue of less than a quarter, although no
/// edge is missing. Where a sheet bends in one direction, its tensor may show two. |V|
std::vector<char> obtuse_rings(const Points2& pattern, const Triangles&, const Hinges&);

/// Principal curvatures of such a tensor, |k1| >= |k2|, and the direction across the ruling, in
/// which the sheet bends most.
struct Principal {
  double k1, k2;    // [1/m]
  Vector2d across;  // unit vector on the pattern; the ruling is perpendicular to it
};
Principal principal_curvature(const Vector3d& tensor);

/// Turning angle of the sheet in its second principal direction, by vertex.
struct SecondTurn {
  std::vector<char> border;  // 1: the vertex lies on the border
  std::vector<double> area;  // [m2] A_v: a third of the area of the triangles around the vertex
  std::vector<double> turn;  // [rad] |k2| sqrt(A_v)
};
/// hinges     of the triangles of the sheet
/// curvature  |V|x3 [1/m] Sxx, Sxy, Syy of the vertices
SecondTurn second_turn(const Sheet&, const Hinges&, const Points3& curvature);

}  // namespace paperbake
