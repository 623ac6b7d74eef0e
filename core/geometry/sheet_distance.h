#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

namespace paperbake {

/// Smallest distance between two sheets, 0 where they intersect, but at most `within`. [m]
double distance_between(const Sheet&, const Sheet&, double within);

/// Smallest distance from another sheet of points of a sheet that are well inside its outline, a
/// sixteenth of its sides apart, but at most `within`: small where sheets lie on each other, and
/// large where they only have a border in common. [m]
double distance_of_inside(const Pattern&, const Sheet&, const Sheet& other, double within);

/// Fraction of the vertices of both sheets that are closer to the other sheet than `distance` [m].
/// [1]
double share_within(const Sheet&, const Sheet&, double distance);

}  // namespace paperbake
