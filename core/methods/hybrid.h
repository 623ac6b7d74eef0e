#pragma once

#include "core/methods/method.h"
#include "core/model/paper.h"
#include "core/step2_crumple/crumple.h"

#include <cstdint>

namespace paperbake {

/// The number of equilateral triangles that stand in two rows across a sheet of this mean width. A
/// single row, as a narrow strip would have it, is a zigzag: its hinges all lean to one side and
/// then to the other, and couple bending with twist. (A tissue strip of 1000 x 30 mm that hangs and
/// is waved strayed sideways by 112 mm on one row, and by 22 mm on two.)
int triangles_in_two_rows(const Pattern&);

/// The hybrid of [Schreck 2015]: a coarse mesh, at first the given lattice, whose edges follow the
/// rulings and which gets singular points where bending directions conflict, up to
/// options.max_triangles. Finer first meshes have up to options.max_first_triangles.
/// seed, sheet  what the random draws of singular points depend on
MethodChoice hybrid(const Pattern&, const Paper&, const FirstLattice&, const CrumpleOptions&,
                    std::uint32_t seed, std::uint32_t sheet);

}  // namespace paperbake
