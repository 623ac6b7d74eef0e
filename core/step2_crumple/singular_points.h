#pragma once

#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "core/step2_crumple/crumple.h"

#include <optional>
#include <vector>

namespace paperbake {

/// Where paper bends in two directions at once, by vertex. It shows in two ways: as a second
/// curvature, and where folds of both signs meet in one vertex, as the ridges and the valley of a
/// d-cone do; along a ruling all folds have one sign.
struct Conflicts {
  // [rad] q_v = |k2| sqrt(A_v), the turning angle in the second direction, or the smaller one of
  // the largest
  std::vector<double> turn;
  //       folds of either sign, whichever is more; 0 where nothing may
  //       be born
  std::vector<char> exceeds;  // more than paper does
  // [1/m2] A_v max(0, k1 k2)^2: how much it looks like the core of a new d-cone; 0 where turn is
  std::vector<double> core_weight = {};
  std::vector<char> severe = {};  // as much as only a singular point can take
};
/// fixed  vertices that are held: a point load is no d-cone
Conflicts find_conflicts(const Sheet&, const Points3& curvature, const std::vector<char>& fixed,
                         const CrumpleOptions&);

/// Length of the longest edge at a vertex, on the pattern. [m]
double ring_size(const Sheet&, int vertex);

/// Where a conflict points to. The vertices are too coarse to say it by the worst one: a d-cone
/// shows as positive Gauss curvature in its core, between saddles, so its middle is the mean of the
/// free vertices within 1.6 rings of the worst, weighted with `core`; where nothing bulges, the
/// mean of the members weighted with the square of the turning angle. (S8 on 160 meshes of 100-250
/// triangles, the first vertex beyond 6 degrees: within (50 +- 2, 10-20) mm 27 times of 69, scatter
/// 6.9 x 7.4 mm; by the turning angles alone 12 times, 11.1 x 7.6 mm.)
/// members  vertices of the conflict, at least one
Vector2d middle_of_conflict(const Sheet&, const Conflicts&, const std::vector<int>& members);

/// How near singular points may come: each ends ridges half as wide as a ridge across the whole
/// sheet, with as much of a facet between them. So heavier paper has larger facets, and a large
/// sheet larger ones than a small sheet. [m]
double min_spacing(const Pattern&, const Paper&, const CrumpleOptions&);

/// The law of [Schreck 2015]: a point drawn from a Gaussian about the middle of the conflict, with
/// the deviation of the paper grade, within the sheet, not where it is forbidden and not too near
/// to border and other points; after 20 refused draws the middle itself.
/// members  vertices of the conflict
/// event    number of the birth on this sheet: the draw depends on seed, sheet and event alone
/// returns  [m] nothing when even the middle is too near to another singular point, or forbidden
std::optional<Vector2d> draw_singular_point(const Sheet&, const Pattern&, const Paper&,
                                            const Conflicts&, const std::vector<int>& members,
                                            const CrumpleOptions&, std::uint32_t seed,
                                            std::uint32_t sheet_number, std::uint32_t event);

/// Makes p a vertex of the mesh: a free inner vertex nearby moves there on the pattern, else the
/// edge or the triangle under p is split. Position and velocity are interpolated. Where that would
/// take the sheet through itself, the triangle under p is split in three: that moves nothing, but
/// the vertex may come to lie a little beside p. returns the vertex
int insert_vertex(Sheet&, const Vector2d& p, const std::vector<char>& fixed);

}  // namespace paperbake
