#pragma once

#include "core/model/paper.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// [m] Radius of the core of a cone of size R: 0.3 h^(1/3) R^(2/3). Inside it paper stretches
/// rather than bend more sharply, and the sheet is no cone.
/// (The energy of discs of 25, 50 and 100 mm that are pushed at their tips to a slope of 0.1, on
/// meshes resolved to 0.3 mm, is that of cones with cores of 3.0, 3.5 and 4.0 mm; at a slope of
/// 0.05, of 5.3, 6.1 and 7.2 mm. Crumples are steeper.)
/// source  exponents of the crescent of a d-cone [Cerda 1999, Mowitz 2020]; the prefactor is
///         measured there as 0.2-0.5
double core_radius(const Paper&, double R);

/// Factors on the bending stiffness of the triangles at the apices of cones, for the part of the
/// bending energy that a shape operator constant per triangle misses there.
///
/// A cone of geodesic curvature kg has the curvature kg/rho at the distance rho from its apex, so a
/// sector dphi between the radii r_c and r stores D/2 kg^2 dphi ln(r/r_c). A triangle with a corner
/// at the apex knows only the average of the curvature, 2 kg/r, and stores D/2 kg^2 dphi 2, however
/// large it is. So its bending stiffness is multiplied by
///
///   f = 1/2 <ln(r/r_c)>,   at least 1/4
///
/// r    from the apex to the opposite edge; < > is the mean over the angle at the apex
/// r_c  core_radius of the cone, with R from the apex to the nearest other one, or to the border
/// 1/4  for a cone no larger than its core: ln = 1/2 is what the core itself stores when it bends
///      evenly
///
/// A triangle with several apices takes the mean of their factors; all other triangles have 1. A
/// point that is held is no apex.
/// returns  |T| factors on the bending stiffness; empty if there is no singular point
/// source   this project
std::vector<double> apex_stiffness_factors(const Sheet&, const Paper&);

}  // namespace paperbake
