#pragma once

#include "core/geometry/random.h"
#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "core/step2_crumple/crumple_options.h"

#include <optional>
#include <vector>

namespace paperbake {

/// Where paper would bend in two directions at once, by vertex. A conflict shows in two ways: as a
/// second principal curvature, and as folds (dihedral angles) of both signs that meet at one
/// vertex, as the ridges and the valley of a d-cone do; along a ruling all folds have one sign.
struct Conflicts {
  // [rad] the larger of two angles: the turning angle q_v = |k2| sqrt(A_v) in the second direction,
  // and the smaller one of the largest folds of either sign; 0 where nothing may be born
  std::vector<double> turn;
  std::vector<char> exceeds;  // 1: more than paper does
  // [1/m2] A_v max(0, k1 k2)^2: how much the vertex looks like the core of a new d-cone; 0 where
  // nothing may be born and, below the thresholds, next to a singular point
  std::vector<double> core_weight = {};
  std::vector<char> severe = {};  // 1: so severe that only a singular point can take it
};
/// Finds the conflicts of a sheet.
/// curvature  |V|x3 [1/m] Sxx, Sxy, Syy of the vertices
/// fixed      vertices that are held: a point load is not a d-cone
Conflicts find_conflicts(const Sheet&, const Points3& curvature, const std::vector<char>& fixed,
                         const CrumpleOptions&);

/// The point at which a conflict is aimed. The mesh is too coarse to take the worst vertex: a
/// d-cone shows as positive Gaussian curvature in its core, between saddles, so its middle is the
/// mean of the free vertices within 1.6 ring sizes of the worst one, weighted with `core_weight`.
/// Where nothing bulges, it is the mean of the members, weighted with the square of the turning
/// angle. (S8 on 160 meshes of 100-250 triangles, first vertex beyond 6 degrees: the middle lies
/// within (50 +- 2, 10-20) mm 27 times of 69, with a scatter of 6.9 x 7.4 mm; by the turning angles
/// alone 12 times, with 11.1 x 7.6 mm.)
/// members  vertices of the conflict, at least one
Vector2d middle_of_conflict(const Sheet&, const Conflicts&, const std::vector<int>& members);

/// Least distance between singular points. The ridges that end in one are half as wide as a ridge
/// across the whole sheet, and there is as much of a facet between them. Thus heavier paper has
/// larger facets, and a large sheet has larger ones than a small sheet. [m]
double min_spacing(const Pattern&, const Paper&, const CrumpleOptions&);

/// Where a singular point is to be born.
struct SingularPointAim {
  Vector2d middle;  // [m] middle_of_conflict()
  double spacing;   // [m] least distance from other points
};

/// Draws the place of a new singular point by the law of [Schreck 2015]: from a Gaussian around the
/// middle of the conflict with the standard deviation of the paper grade, within the sheet, not
/// where it is forbidden and not too close to the border or to other points. After 20 rejected
/// draws it is the middle itself.
/// birth    its number is that of the birth on this sheet
/// returns  [m] nothing when even the middle is forbidden or too close to another singular point
std::optional<Vector2d> draw_singular_point(const Sheet&, const Pattern&, const Paper&,
                                            const SingularPointAim&, const CrumpleOptions&,
                                            const RandomEvent& birth);

/// Makes p a vertex of the mesh: a free inner vertex nearby is moved there on the pattern,
/// otherwise the edge or the triangle under p is split. Position and velocity are interpolated.
/// Where that would take the sheet through itself, the triangle under p is split in three: that
/// moves nothing, but the vertex may come to lie a little beside p.
/// fixed    1: a vertex that must not be moved
/// returns  number of the vertex
int insert_vertex(Sheet&, const Vector2d& p, const std::vector<char>& fixed);

}  // namespace paperbake
