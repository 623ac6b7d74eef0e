#pragma once

#include "core/animation/found_fold.h"
#include "core/model/fold_line.h"

#include <optional>

namespace paperbake {

/// The place of a fold that colliders press with which both its sides can lie flat and straight
/// between it and their handles. With the coordinate c across the line on the pattern, and s in
/// space, along the faces and towards the fold, one side lies at s = u + c and the other, folded
/// back about c = d, at s = u + 2 d - c; so the means over the handles of the two sides give
///
///   d = (s_far - s_near + c_far + c_near)/2
///
/// returns  nothing if no collider presses the sheet there, or one side has no handle
std::optional<FoldLine> taut_place(const FoldLine&, const UnfoldedSheet&);

/// The place of a fold with which both its sides can stay flat until the end of the shot, where the
/// line as it was found does not allow that. Two flat sides that are folded shut bring a point p of
/// one and a point q of the other to the distance of p and the mirror image of q in the line, and
/// no nearer. All keys are known: so let e be by how much that distance is larger than the least
/// one between two handles on either side in the frames to come, for the pair where it is largest.
/// If e > 0 the line moves, each of its ends by a row of triangles at most, to where e is least.
///
/// returns  nothing if both sides can stay flat where the line is, or nowhere near it
std::optional<FoldLine> flat_place(const FoldLine&, const UnfoldedSheet&);

}  // namespace paperbake
