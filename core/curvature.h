#pragma once

#include "core/sheet.h"

namespace paperbake {

/// Curvature tensor of the sheet at each vertex, in pattern coordinates, averaged over its one-ring:
///
///   S_v = [ sum_spokes theta l n (x) n  +  1/2 sum_link theta l n (x) n ] / sum A(one-ring)
///
/// theta the dihedral angle, l the length and n the unit normal of an edge in the pattern. A sheet that bulges towards
/// its normal (counter-clockwise side) has positive curvature. Border edges turn nothing.
/// returns  |V|x3 [1/m]  Sxx, Sxy, Syy
Points3 vertex_curvature(const Sheet&);

/// Principal curvatures of one such tensor, |k1| >= |k2|, and the direction across which the sheet bends most.
struct Principal {
  double k1, k2;       // [1/m]
  Vector2d across;     // unit, pattern; the ruling is perpendicular to it
};
Principal principal_curvature(const Vector3d& tensor);

}  // namespace paperbake
