#pragma once

#include "core/step1_elastic/contact/barrier.h"
#include "core/step1_elastic/contact/collider_distances.h"

namespace paperbake {

/// Barrier energy of a collider, of the distance d from its front.
///
///   b(d) = -kappa (d - dhat)^2 ln(d/dhat);  0 from dhat on
///
/// From 0.005 dhat down it is continued by its Taylor polynomial of degree 2. So a sheet may begin
/// inside the collider, as one that was modelled lying on the ground does.
///
/// kappa = 200 N/m, dhat = 0.5 mm: the force is 0.6 N at a distance of 0.1 mm, 6 N at 10 um, and
/// 21 N at 2.5 um, where the polynomial begins; it then grows by 8 N a micrometre. So handles,
/// which hold the paper with 3 N, give way before the paper is pressed into a collider.
/// source  [Li 2020], as a function of the distance itself; the polynomial: this project
Barrier collider_barrier(double distance);

}  // namespace paperbake
