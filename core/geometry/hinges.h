#pragma once

#include "core/model/sheet.h"

#include <array>
#include <vector>

namespace paperbake {

/// Two triangles that share an edge: edge 0-1, wing 2 on its left (counter-clockwise side of the
/// first), wing 3 on its right.
struct Hinge {
  std::array<int, 4> vertices;
  std::array<int, 2> triangles;  // left, right
};

/// All inner edges of a mesh; `of_triangle[t][i]` is the hinge on the edge opposite corner i of
/// triangle t, -1 on the border.
struct Hinges {
  std::vector<Hinge> hinges;
  std::vector<std::array<int, 3>> of_triangle;
};
/// throws Error(Fault::simulation) when an edge has more than two triangles
Hinges find_hinges(const Triangles&);

/// Dihedral angle of a hinge: 0 = flat, > 0 = bulges towards the normals, in (-pi, pi]. [rad]
double dihedral_angle(const Points3& x, const Hinge&);
/// Of all hinges. [rad]
std::vector<double> dihedral_angles(const Points3& x, const std::vector<Hinge>&);

}  // namespace paperbake
