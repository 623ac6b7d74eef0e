#pragma once

#include "core/hinges.h"
#include "core/sheet.h"

#include <vector>

namespace paperbake {

/// The line that the segment a-b lies on; null: none.
const FoldLine* fold_under(const std::vector<FoldLine>&, const Vector2d& a, const Vector2d& b);

/// Of each hinge of the sheet's mesh: the line that it lies on; null: none. Empty when the sheet has no lines.
std::vector<const FoldLine*> fold_lines(const Sheet&, const Hinges&);
bool on_fold(const std::vector<FoldLine>&, const Points2& pattern, int a, int b);  // an edge of a mesh

/// Every point where one of the lines crosses another or turns, and all its ends: what a mesh has to have as vertices, besides. [m]
std::vector<Vector2d> fold_stops(const std::vector<FoldLine>&);

/// What a crease resists: D / 50 mm. It stores k/2 (theta - angle)^2 for each metre of its length; k [N].
/// (The stiffness of creases in paper and board is that of a strip of the flat sheet between 25 and 100 mm wide.)
/// source  the range [Filipov 2017]; 50 mm is this project's, not measured
inline double crease_stiffness(double bending_stiffness) { return bending_stiffness / 0.05; }

}  // namespace paperbake
