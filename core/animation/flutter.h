#pragma once

#include "core/model/air.h"
#include "core/model/shot.h"

namespace paperbake {

/// Length of the waves that grow fastest on an endless flat sheet along which air flows. With the
/// pressure that the air of the elastic step has on average at small angles, a wave w(s, t) obeys
///
///   rho w_tt + D w_ssss + P (w_s + w_t/U) = 0,   P = C_d rho_air U^2/2.
///
/// Waves shorter than 2 pi sqrt(D/rho)/U die away, whatever the density of the air; all longer ones
/// grow.
/// air_density  [kg/m3] above 0
/// speed        U [m/s] above 0
/// returns      [m]
/// source       this project, from the balance of forces
double flutter_wavelength(const Paper&, double air_density, double speed);

/// Highest speed, without gusts, with which the winds of a shot blow along a flag: a sheet that is
/// held at a point or on a line in its first frame, and whose start shape streams from there within
/// 45 degrees of the wind. [m/s] 0 for any other sheet
/// first_frame  the first one of the shot
double speed_along_flag(const Shot&, const Air&, int first_frame);

/// Length of edges on which a flag can wave: a twelfth of the waves that grow fastest. Infinite for
/// sheets that are no flags. On half as many edges, flags of washi, newsprint and copier paper
/// stream out nearly like boards. [m]
double longest_edge_of_flag(const Shot&, const Air&, int first_frame);

}  // namespace paperbake
