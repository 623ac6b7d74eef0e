#pragma once

#include "core/model/degrees.h"
#include "core/model/paper.h"

#include <cmath>

namespace paperbake {

/// How a folded crease turns, for each unit of its length.
struct CreaseLaw {
  double stiffness;     // k [N/rad]
  double yield_moment;  // M_s [N]
  double hardening;     // H [N/rad]
  double pressing;      // K [N/rad] of hands that press it to an angle
};

/// The law of the creases of a paper:
///
///   k   = D / 150 h, where 150 h is 13.5 mm for office paper
///   M_s = 0.6 D k_y, with k_y = 2 eps_y/h: a crease is weaker than the paper beside it, or that
///         would fold instead
///   H   = 0.03 k: a little, so that the tangent never vanishes
///   K   = D k_y / 3 degrees: hands hold their angle to 3 degrees until paper beside them yields
///
/// source  150 h: prefolded paper, 147 h at 0.129 mm [Pradier 2016], 185 h at 0.27 mm
///         [Yasuda 2013], both from the survey of [Filipov 2017]; 10-100 h and more
///         [Lechenault 2014]; 0.6, 0.03 and 3 degrees: assumed. Copy paper that was folded flat
///         and let go keeps a turn of 128 degrees with them; by hand, without a nail, 90-130 are
///         usual.
inline CreaseLaw crease_law(const Paper& paper) {
  const double k = paper.bending_stiffness / (150 * paper.thickness);
  const double first_yield = paper.bending_stiffness * 2 * paper.yield_strain / paper.thickness;
  return {k, 0.6 * first_yield, 0.03 * k, first_yield / radians_of(3)};
}

/// State of a crease at a dihedral angle theta [rad], when it sprang back to `rest` [rad] at the
/// beginning of the step. The rest angle follows within the step, by radial return:
///
///   psi(theta) = min over p of  k/2 (theta - p)^2 + H/2 p^2 + M_s |p - rest|
///
/// It is convex in theta, and a step may be divided.
struct CreaseResponse {
  double energy;   // [N] psi
  double moment;   // [N] dpsi/dtheta
  double tangent;  // [N/rad] d2psi/dtheta2 > 0
  double rest;     // [rad] p: what it springs back to when the step ends here
};
inline CreaseResponse turn_crease(const CreaseLaw& law, double rest, double theta) {
  const double k = law.stiffness, yield_moment = law.yield_moment, H = law.hardening;
  const double drive = k * (theta - rest) - H * rest;  // on the rest angle
  double p = rest, tangent = k, dissipated = 0;
  if (const double beyond = std::abs(drive) - yield_moment; beyond > 0) {
    p += (drive > 0 ? beyond : -beyond) / (k + H);
    tangent = k * H / (k + H);
    dissipated = yield_moment * std::abs(p - rest);
  }
  return {0.5 * k * (theta - p) * (theta - p) + 0.5 * H * p * p + dissipated, k * (theta - p),
          tangent, p};
}

/// The same for a crease that hands press to the angle `pressed` [rad]: their moment takes the
/// place of its own, and its rest angle yields as it does without them.
inline CreaseResponse press_crease(const CreaseLaw& law, double rest, double pressed,
                                   double theta) {
  const double off = theta - pressed;
  return {0.5 * law.pressing * off * off, law.pressing * off, law.pressing,
          turn_crease(law, rest, theta).rest};
}

}  // namespace paperbake
