#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// A few long waves over the pattern, of size 1, that depend on the seed and not on the mesh: every
/// mesh buckles to the same side.
/// p     [m] on the pattern
/// side  [m] the longer one of the pattern
double imperfection(const Vector2d& p, double side, unsigned seed);

/// How far the points are at most from the plane that lies nearest to all of them. [m]
double off_plane(const Points3&);

/// Adds a ripple of 1e-6 m along the common normal when all points lie in one plane: it lets a flat
/// sheet choose a side.
void add_geometric_imperfection(Sheet&, double side, unsigned seed);

}  // namespace paperbake
