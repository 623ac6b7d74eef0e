#pragma once

#include "core/geometry/hinges.h"
#include "core/model/paper.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The prescribed crease on which the segment a-b lies; null: none.
const PrescribedCrease* crease_under(const std::vector<PrescribedCrease>&, const Vector2d& a,
                                     const Vector2d& b);

/// For each hinge of the sheet's mesh, the prescribed crease on which it lies; null: none. Empty
/// when the sheet has no prescribed creases.
std::vector<const PrescribedCrease*> crease_of_hinges(const Sheet&, const Hinges&);
/// True when the mesh edge between vertices a and b lies on a prescribed crease.
bool is_on_crease(const std::vector<PrescribedCrease>&, const Points2& pattern, int a, int b);

/// All points at which prescribed creases cross, turn or end: a mesh must have vertices there. [m]
std::vector<Vector2d> crease_points(const std::vector<PrescribedCrease>&);

/// Stiffness k [N] of a prescribed crease per unit length: D / 150 h, where 150 h is 13.5 mm for
/// office paper. The crease stores k/2 (theta - angle)^2 per metre of its length.
/// source  prefolded paper: 147 h at 0.129 mm [Pradier 2016], 185 h at 0.27 mm [Yasuda 2013], both
///         from the survey of [Filipov 2017]; virgin creases of board 1.6-133 mm
inline double crease_stiffness(const Paper& paper) {
  return paper.bending_stiffness / (150 * paper.thickness);
}

}  // namespace paperbake
