#pragma once

#include "core/geometry/collider.h"

#include <optional>

namespace paperbake {

/// A gap between two faces of colliders that are parallel to within 15 degrees.
struct ColliderGap {
  double width;     // [m] sum of the distances of a point in it from the two faces
  Vector3d normal;  // unit vector across it
};

/// The narrowest gap that a point is in, or would be in if it were not pressed into a face. Open
/// colliders are regarded from their fronts.
///
/// widest   [m] width of the gaps that are looked for
/// returns  nothing if there is none
std::optional<ColliderGap> gap_around(const ColliderShapes&, const Vector3d& p, double widest);

}  // namespace paperbake
