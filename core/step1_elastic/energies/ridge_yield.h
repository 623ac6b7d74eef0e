#pragma once

#include "core/geometry/hinges.h"
#include "core/model/paper.h"
#include "core/model/sheet.h"

namespace paperbake {

/// What a coarse mesh does not show: where paper bends in two directions it goes into flat facets
/// between sharp ridges, and the fibres of a ridge break long before the mean curvature of a
/// triangle says so.
struct RidgeField {
  Eigen::VectorXd share;  // |T| s in [0, 1]: 0 smooth bending, 1 a ridge
  // |T| m >= 1: curvature in the ridge over the mean curvature of the triangle
  Eigen::VectorXd focus;
};

/// From the turning angle in the second direction q = |k2| sqrt(A) of the vertices of a triangle
/// and of those within X/2 of it:
///
///   s = clamp((q - 6 deg) / 9 deg), at least what is remembered
///   m = (1 - s) + s max(1, d/w, X/2w)
///
/// d  [m] size of the triangle across its ruling: its height when one edge lies along it
/// w  [m] ridge_width between facets of size X
/// X  [m] sqrt(area / number of points where ridges end: what is held, singular points; at least 4)
///
/// A mesh finer than facets spreads the fold of a ridge over several triangles, each of which then
/// yields no later than the one of a coarse mesh: half a facet has one ridge, whatever the number
/// of triangles in it. (S4, 185/320/635 triangles, plastic turn of frame 48: 0.80, 0.47, 0.42 m rad
/// by d alone, 0.88, 0.71, 0.72 with X/2.) Vertices that are held or on the border do not count: a
/// point load is no ridge.
/// remembered  |T| s of earlier frames
/// hinges      of the sheet's triangles
/// source      this project's, angles measured on S4
RidgeField find_ridges(const Sheet&, const Hinges&, const Paper&, const std::vector<int>& held,
                       const Eigen::VectorXd& remembered);

}  // namespace paperbake
