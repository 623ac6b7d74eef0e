#pragma once

#include "core/geometry/hinges.h"
#include "core/model/segment2.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The prescribed crease on which the segment a-b lies; null: none.
const PrescribedCrease* crease_under(const std::vector<PrescribedCrease>&, const Vector2d& a,
                                     const Vector2d& b);

/// Whether a mesh edge is a part of a straight line, to within rounding.
bool is_part(const Segment2& edge, const Segment2& line);

/// For each hinge of the sheet's mesh, the prescribed crease on which it lies; null: none. Empty
/// when the sheet has no prescribed creases.
std::vector<const PrescribedCrease*> crease_of_hinges(const Sheet&, const Hinges&);
/// True when the mesh edge between vertices a and b lies on a prescribed crease.
bool is_on_crease(const std::vector<PrescribedCrease>&, const Points2& pattern, int a, int b);

/// All points at which prescribed creases cross, turn or end: a mesh must have vertices there. [m]
std::vector<Vector2d> crease_points(const std::vector<PrescribedCrease>&);

/// State of a crease on the mesh edge a-b, which lies on it: the mean over the parts of the edge
/// whose state the sheet knows, or that of the first frame. An edge is folded where any part is.
CreaseEdge crease_edge(const Sheet&, const PrescribedCrease&, const Vector2d& a, const Vector2d& b);

/// True when the mesh edge between vertices a and b lies on a prescribed crease that is folded
/// there.
bool is_folded(const Sheet&, int a, int b);

/// Whether each prescribed crease of the sheet is folded somewhere.
std::vector<bool> which_are_folded(const Sheet&);

/// The prescribed creases of the sheet that are folded somewhere.
std::vector<PrescribedCrease> folded_creases(const Sheet&);

}  // namespace paperbake
