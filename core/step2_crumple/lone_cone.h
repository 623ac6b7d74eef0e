#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <optional>
#include <vector>

namespace paperbake {

/// The apex of the cone that a whole sheet forms, as a disc does that a finger pushes into a ring:
/// all of its paper bends about lines through one point. How well it does is the mean of
/// cos^2(angle between such a line and the direction across the ruling), weighted with the bending
/// |k1| dA. It is 0 on a cone and 1/2 where rulings have any direction; no more than a quarter
/// counts as a cone. (A disc in a ring, about the points of its finger: 0.05 to 0.12 on 120
/// triangles. The samples S0, S4, S8, S12 and S14 before they crumple, about each of their held and
/// singular points: 0.41 to 0.68.)
///
/// Where all of the sheet is one cone, bending in two directions beside its apex is the error of
/// the mesh: near the apex the triangles around a vertex span rulings of both signs.
///
/// curvature  |V|x3 [1/m] Sxx, Sxy, Syy of the vertices
/// returns    [m] nothing when the sheet bends in another way, or when the apex lies beside it
/// source     this project
std::optional<Vector2d> apex_of_lone_cone(const Sheet&, const Pattern&, const Points3& curvature);

/// Whether the apex of a cone is held, or is a singular point already, as far as the mesh can tell:
/// it is no farther away than a mean edge.
/// held  |V| 1: the vertex belongs to a handle
bool is_apex_taken(const Sheet&, const std::vector<char>& held, const Vector2d& apex);

}  // namespace paperbake
