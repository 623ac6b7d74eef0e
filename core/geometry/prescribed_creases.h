#pragma once

#include "core/geometry/hinges.h"
#include "core/model/paper.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The line that the segment a-b lies on; null: none.
const PrescribedCrease* crease_under(const std::vector<PrescribedCrease>&, const Vector2d& a,
                                     const Vector2d& b);

/// Of each hinge of the sheet's mesh: the line that it lies on; null: none. Empty when the sheet
/// has no lines.
std::vector<const PrescribedCrease*> crease_of_hinges(const Sheet&, const Hinges&);
// an edge of a mesh
bool is_on_crease(const std::vector<PrescribedCrease>&, const Points2& pattern, int a, int b);

/// Every point where one of the lines crosses another or turns, and all its ends: what a mesh has
/// to have as vertices, besides. [m]
std::vector<Vector2d> crease_points(const std::vector<PrescribedCrease>&);

/// What a crease resists: D / 150 h, 13.5 mm of office paper. It stores k/2 (theta - angle)^2 for
/// each metre of its length; k [N].
/// source  paper of 0.129 mm prefolded: 147 h [Pradier 2016]; 0.27 mm: 185 h [Yasuda]; virgin
///         creases of board 1.6-133 mm
inline double crease_stiffness(const Paper& paper) {
  return paper.bending_stiffness / (150 * paper.thickness);
}

}  // namespace paperbake
