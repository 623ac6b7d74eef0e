#pragma once

#include "core/sheet.h"

namespace paperbake {

/// A few long waves over the pattern, of size 1, that depend on the seed and not on the mesh: every mesh buckles to the same side.
/// p     [m] on the pattern
/// side  [m] the longer one of the pattern
double ripple(const Vector2d& p, double side, unsigned seed);

}  // namespace paperbake
