#pragma once

#include "core/paper.h"
#include "core/pattern.h"
#include "core/sheet.h"
#include "core/step2_crumple/crumple.h"

#include <optional>
#include <vector>

namespace paperbake {

/// Where paper bends in two directions at once, by vertex.
struct Conflicts {
  std::vector<double> turn;  // [rad] q_v = |k2| sqrt(A_v), the turning angle in the second direction; 0 where nothing may be born
  std::vector<char> beyond;  // more than paper does
};
/// fixed  vertices that are held: a point load is no d-cone
Conflicts find_conflicts(const Sheet&, const Points3& curvature, const std::vector<char>& fixed, const CrumpleOptions&);

/// The law of [Schreck 2015]: a point drawn from a Gaussian about the middle of the conflict (mean weighted with the square of
/// the turning angle), with the deviation of the paper grade, within the sheet and not too near to border and other points;
/// after 20 refused draws the middle itself.
/// members  vertices of the conflict
/// event    number of the birth on this sheet: the draw depends on seed, sheet and event alone
/// returns  [m] nothing when even the middle is too near to another singular point
std::optional<Vector2d> draw_singular_point(const Sheet&, const Pattern&, const Paper&, const Conflicts&, const std::vector<int>& members,
                                            const CrumpleOptions&, std::uint32_t seed, std::uint32_t sheet_number, std::uint32_t event);

/// Makes p a vertex of the mesh: a free inner vertex nearby moves there on the pattern, else the edge or the triangle under p
/// is split. Position and velocity are interpolated. Where that would take the sheet through itself, the triangle under p is
/// split in three: that moves nothing, but the vertex may come to lie a little beside p. returns the vertex
int insert_vertex(Sheet&, const Vector2d& p, const std::vector<char>& fixed);

}  // namespace paperbake
