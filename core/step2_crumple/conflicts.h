#pragma once

#include "core/model/sheet.h"
#include "core/step2_crumple/crumple_options.h"

#include <algorithm>
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
  bool any() const { return std::count(exceeds.begin(), exceeds.end(), 1) > 0; }
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

}  // namespace paperbake
