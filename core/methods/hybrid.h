#pragma once

#include "core/methods/method.h"
#include "core/model/paper.h"
#include "core/step2_crumple/crumple.h"

#include <cstdint>

namespace paperbake {

/// The hybrid of [Schreck 2015]: a coarse mesh, at first the given lattice, whose edges follow the
/// rulings and which gets singular points where bending directions conflict, up to
/// options.max_triangles. Finer first meshes have up to options.max_first_triangles.
/// seed, sheet  what the random draws of singular points depend on
MethodChoice hybrid(const Pattern&, const Paper&, const FirstLattice&, const CrumpleOptions&,
                    std::uint32_t seed, std::uint32_t sheet);

}  // namespace paperbake
