#pragma once

#include "core/paper.h"
#include "core/sheet.h"

#include <vector>

namespace paperbake {

/// What a coarse mesh does not show: where paper bends in two directions it goes into flat facets between sharp ridges, and
/// the fibres of a ridge break long before the mean curvature of a triangle says so.
struct Ridges {
  Eigen::VectorXd share;  // |T| s in [0, 1]: 0 smooth bending, 1 a ridge
  Eigen::VectorXd focus;  // |T| m >= 1: curvature in the ridge over the mean curvature of the triangle
};

/// From the turning angle in the second direction q = |k2| sqrt(A) of the vertices of a triangle and of those within X/2 of it:
///
///   s = clamp((q - 6 deg) / 9 deg), at least what is remembered
///   m = (1 - s) + s max(1, d/w)
///
/// d  [m] size of the triangle across its ruling: its height when one edge lies along it
/// w  [m] width of a ridge between facets of size X: 0.4 h^(1/3) X^(2/3)
/// X  [m] sqrt(area / number of points where ridges end: what is held, singular points; at least 4)
///
/// Vertices that are held or on the border do not count: a point load is no ridge.
/// remembered  |T| s of earlier frames
/// source      exponents of the stretching ridge [Lobkovsky 1996]; prefactor and angles are this project's, measured on S4
Ridges find_ridges(const Sheet&, const Paper&, const std::vector<int>& held, const Eigen::VectorXd& remembered);

}  // namespace paperbake
