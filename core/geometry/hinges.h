#pragma once

#include "core/model/sheet.h"

#include <array>
#include <vector>

namespace paperbake {

/// An inner edge of a mesh with its two triangles. Vertices 0 and 1 are the ends of the edge.
/// Vertex 2 is the third corner (the wing) of the left triangle, on the counter-clockwise side of
/// the edge from 0 to 1, and vertex 3 is that of the right triangle.
struct Hinge {
  std::array<int, 4> vertices;
  std::array<int, 2> triangles;  // left, right
};

/// All inner edges of a mesh. `of_triangle[t][i]` is the number of the hinge on the edge opposite
/// corner i of triangle t, or -1 on the border.
struct Hinges {
  std::vector<Hinge> hinges;
  std::vector<std::array<int, 3>> of_triangle;
};
/// Finds all inner edges of a mesh.
/// throws Error(ErrorCode::simulation) when an edge has more than two triangles,
///        or two of opposite orientation
Hinges find_hinges(const Triangles&);

/// Dihedral angle of a hinge, in (-pi, pi]: 0 is flat, > 0 bulges towards the normals. [rad]
double dihedral_angle(const Points3& x, const Hinge&);
/// Dihedral angles of all hinges. [rad]
std::vector<double> dihedral_angles(const Points3& x, const std::vector<Hinge>&);

}  // namespace paperbake
