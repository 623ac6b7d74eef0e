#pragma once

#include "core/model/sheet.h"

#include <cmath>
#include <vector>

namespace paperbake {

/// How a sheet that is let go swings about its new equilibrium.
struct Swing {
  double amplitude = 0;  // [m] largest displacement from there, see swing_to
  double rate = 0;       // [rad/s] 0: it does not swing
};

/// The swing of a sheet that is let go at rest. On its way d from there to equilibrium it frees the
/// energy W. If it went that way as an oscillator does, its rate would be that of Rayleigh's
/// quotient,
///
///   w^2 = 2 W / sum_i m_i |d_i|^2
///
/// d is taken without the nearest rigid motion that the vertices which are still held allow: a
/// sheet that nothing holds may drift and turn, one that is held by a line may turn about it, and
/// neither is a swing.
///
/// equilibrium   the sheet there
/// from          |V|x3 [m] where it is let go
/// held          vertices that are still held
/// freed         [J] W: by how much its potential is lower at equilibrium; not positive: rate is 0
/// area_density  [kg/m2]
/// source        this project; the quotient is in any textbook of vibrations
Swing swing_to(const Sheet& equilibrium, const Points3& from, const std::vector<int>& held,
               double freed, double area_density);

/// [s] The time from rest to equilibrium.
double quarter_period(const Swing&);

/// [rad/s] 12 swings a second.
inline constexpr double fastest_swing = 2 * M_PI * 12;

/// [1/s] The damping, as in ElasticOptions, that lets a sheet sink under its weight as fast as it
/// can without swinging: 2 w, with w^2 = 1.545 g/d of a cantilever whose tip sinks by the amplitude
/// d (d = rho g L^4/(8 D), w = 3.516 sqrt(D/rho)/L^2).
/// gravity  [m/s2]
double critical_damping(const Swing&, double gravity);

/// [1] of the longer side: motions of less are not seen, and other errors of a frame go as far.
inline constexpr double visible_motion = 0.005;

/// Whether a sheet must have inertia while it swings like this. It need not
///
/// - if it moves by less than visible_motion; or
/// - if it swings more than 12 times a second. It is at equilibrium in less than 1/48 s then, 24
///   frames a second cannot show such a swing, and backward Euler in steps of 1/96 s would leave a
///   seventh of it after one period.
///
/// side  [m] longer side of the pattern
bool needs_inertia(const Swing&, double side);

/// [m] A sheet that swings by no more than this has come to rest: 0.05 % of its longer side, half a
/// pixel of a sheet that fills a picture of 1000.
double still(double side);

}  // namespace paperbake
