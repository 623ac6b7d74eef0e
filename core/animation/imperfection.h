#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Shape of the geometric imperfection: a few long waves over the pattern, of amplitude 1. They
/// depend on the seed and not on the mesh, so that every mesh buckles to the same side.
/// p     [m] point of the pattern
/// side  [m] longer side of the pattern
double imperfection(const Vector2d& p, double side, unsigned seed);

/// Largest distance of a point from the plane that fits all points best. [m]
double off_plane(const Points3&);

/// Adds a geometric imperfection of 1e-6 m along the common normal when all points lie in one
/// plane, so that a flat sheet can buckle.
/// side  [m] longer side of the pattern
void add_geometric_imperfection(Sheet&, double side, unsigned seed);

}  // namespace paperbake
