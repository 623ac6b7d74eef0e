#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Smallest distance between two sheets, 0 where they intersect, but at most `within`. [m]
double distance_between(const Sheet&, const Sheet&, double within);

/// Fraction of the vertices of both sheets that are closer to the other sheet than `distance` [m].
/// [1]
double share_within(const Sheet&, const Sheet&, double distance);

}  // namespace paperbake
