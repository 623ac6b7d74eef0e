#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Opens the slits of a flat mesh: where two of its border edges lie on each other, as along a cut
/// without width, or less than 1e-4 of the longer side apart, they are moved apart, each by 1e-4 of
/// the longer side towards its own paper, and at most by 0.5 % of the edges there.
/// Their common end, the tip of the slit, stays where it is. Such borders would touch each other,
/// and no mesh would know which side of the cut a point is on.
/// flat  |V|x2 [m]
void open_slits(Points2& flat, const Triangles&);

}  // namespace paperbake
