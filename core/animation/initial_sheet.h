#pragma once

#include "core/methods/method.h"
#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// The first mesh of a shot (start_mesh.h), in the start shape. A flat start gets a geometric
/// imperfection of 1e-6 m along its normal, which depends on the seed and not on the mesh. Singular
/// points that the artist has prescribed are born in the first frame.
struct InitialSheet {
  Sheet sheet;
  std::vector<int> handle_vertex;  // vertex of each handle
  // |V| vertices that have to stay where they are on the pattern: handles, the rims of their discs,
  // prescribed singular points
  std::vector<char> fixed;
  // the mesh has rows of edges along bends of the start shape (start_mesh.h)
  bool has_bends = false;
  // |T| factor on the bending stiffness: 10 inside the discs of handles
  std::vector<double> stiffening;
};
/// method  makes the mesh (Method::first_mesh)
InitialSheet make_initial_sheet(const Shot&, Method&, unsigned seed, int first_frame = 1);

/// The points of the pattern at which every mesh of the sheet has vertices, besides those of
/// creases and of singular points that are born later: the handles, in order, the rims of their
/// discs, then prescribed singular points. [m]
std::vector<Vector2d> required_points(const Shot&);

/// Factor on the bending stiffness of each triangle, for any mesh of the sheet: 10 inside the discs
/// of handles, 1 elsewhere. |T|
std::vector<double> disc_factors(const Sheet&, const Shot&);

}  // namespace paperbake
