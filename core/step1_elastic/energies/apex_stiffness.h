#pragma once

#include "core/model/paper.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Radius inside which a cone of size R is not one: paper stretches there rather than bend more.
/// 0.3 h^(1/3) R^(2/3). [m] (The energy of discs of 25, 50, 100 mm pushed by their tips to a slope
/// of 0.1, resolved to 0.3 mm, is that of cones with cores of 3.0, 3.5, 4.0 mm; at 0.05 5.3, 6.1,
/// 7.2 mm. Crumples are steeper.)
/// source  exponents of the crescent of a d-cone [Cerda 1999, Mowitz 2012]; the prefactor is
///         measured there as 0.2-0.5
double core_radius(const Paper&, double R);

/// What the shape operator of a triangle misses at the apex of a cone. Between radii r_c and r a
/// sector dphi of a cone of geodesic curvature kg stores D/2 kg^2 dphi ln(r/r_c): its curvature is
/// kg/rho. A triangle with its corner at the apex knows the mean, 2 kg/r, alone, and stores D/2
/// kg^2 dphi 2 however large it is. So its rigidity is multiplied by
///
///   f = 1/2 <ln(r/r_c)>,   at least 1/4
///
/// r    from the apex to the opposite edge, < > the mean over the angle at the apex
/// r_c  core_radius of the cone, R: from the apex to the nearest other one, or to the border
/// 1/4  a cone no larger than its core: ln = 1/2 is what the core itself stores when it bends
///      evenly
///
/// A triangle with several apices takes the mean of their factors; all others have 1. A point that
/// is held is no apex.
/// returns  |T| factors on the bending stiffness; empty: there is no singular point
/// source   this project's
std::vector<double> apex_stiffness_factors(const Sheet&, const Paper&);

}  // namespace paperbake
