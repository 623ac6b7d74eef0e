#pragma once

#include "core/methods/method.h"

namespace paperbake {

/// Standard finite elements: step 1 alone on a fixed mesh of near-equilateral triangles.
MethodChoice fem(const FirstLattice&);

}  // namespace paperbake
