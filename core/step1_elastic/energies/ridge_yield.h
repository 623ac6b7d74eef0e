#pragma once

#include "core/geometry/hinges.h"
#include "core/model/paper.h"
#include "core/model/sheet.h"

namespace paperbake {

/// [1] Share of its energy that a ridge between two points of crumpled paper stores by stretching:
/// it stretches with a fifth of the energy with which it bends [Lobkovsky 1997]. A smooth sheet,
/// which can be developed, stretches far less.
inline constexpr double ridge_share = 1.0 / 6;

/// Ridges within the triangles, which a coarse mesh does not show. Paper that bends in two
/// directions forms flat facets between sharp ridges, and the fibres of a ridge break long before
/// the average curvature of a triangle says so.
struct RidgeField {
  Eigen::VectorXd share;  // |T| s in [0, 1]: 0 smooth bending, 1 a ridge
  // |T| m >= 1: curvature in the ridge over the average curvature of the triangle
  Eigen::VectorXd focus;
};

/// Finds the ridges from q = |k2| sqrt(A), the turning angle in the second direction, of the
/// vertices of a triangle and of those within X/2 of it:
///
///   s = clamp((q - 6 deg) / 9 deg), but at least what is remembered
///   m = (1 - s) + s max(1, d/w, X/2w)
///
/// d  [m] size of the triangle across its ruling: its height if one edge lies along the ruling
/// w  [m] ridge_width between facets of size X
/// X  [m] sqrt(area / number of points where ridges end); these are the held and the singular
///    points, at least 4
///
/// A mesh finer than the facets spreads the angle of a ridge over several triangles. With X/2 each
/// of them yields no later than the single triangle of a coarse mesh: half a facet has one ridge,
/// whatever the number of triangles in it. (S4, 185/320/635 triangles, plastic integral of frame
/// 48: 0.80, 0.47, 0.42 m rad with d alone; 0.88, 0.71, 0.72 with X/2.) Vertices that are held or
/// on the border do not count: a point load is no ridge. Nor do those with obtuse_rings().
/// remembered  |T| s of earlier frames
/// hinges      of the sheet's triangles
/// source      this project; angles measured on S4
RidgeField find_ridges(const Sheet&, const Hinges&, const Paper&, const std::vector<int>& held,
                       const Eigen::VectorXd& remembered);

}  // namespace paperbake
