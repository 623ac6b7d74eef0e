#pragma once

#include "core/methods/method.h"
#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// A straight line on the pattern along which the start shape is bent: edges of its mesh, one after
/// the other, that turn the sheet.
struct Bend {
  Vector2d a, b;  // [m] its ends
  double turn;    // [rad] largest absolute dihedral angle of its edges
};

/// All bends of a start shape, the longest first.
std::vector<Bend> bends_of(const Sheet& start);

/// A first mesh, and whether bends are among its rows of edges.
struct StartMesh {
  PatternMesh mesh;
  bool has_bends;
};

/// The first mesh of a shot. Where the start shape is bent more tightly than the method's own mesh
/// can show, so that an edge between two of its points would be 0.2 % too short, bends become rows
/// of edges: as many as it takes, but with no more than 2,000 triangles more. Where the mesh would
/// still pass through itself and the start shape does not, as where a roll lies on the flat
/// part that it ends in, smaller errors count. On a smooth roll the rows are up to 12 degrees of
/// turn apart, because the chord of an arc of angle t is short by t^2 / 24.
/// A start shape that the method's own mesh can show gets that mesh.
/// points  as in Method::first_mesh; the vertices of the bends are not among them
///
/// source  this project
StartMesh mesh_of_start(const Shot&, Method&, const std::vector<Vector2d>& points);

}  // namespace paperbake
