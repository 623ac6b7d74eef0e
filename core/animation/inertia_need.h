#pragma once

#include "core/animation/animate.h"

#include <string>

namespace paperbake {

/// Whether inertia would change the look of a sheet by more than the error of the method, and why.
struct InertiaNeed {
  bool needed = false;
  double sway = 0;  // [1] of the longer side: how far the handles would throw it, see below
  std::string why;
};

/// Decides on inertia from the start shape and the handle curves alone, before anything is
/// simulated:
///
/// - Under gravity, a sheet that nothing holds falls, and one that is held at a point or on a line
///   swings: both need inertia, because without it the sheet would be at rest in quite another
///   shape. The exception is a sheet that hangs below its handles from the first frame on, has a
///   sway of no more than 0.5 %, and is not in the way of a collider that moves.
/// - Any other sheet, and any sheet without gravity, is where its handles bend it, and lags behind
///   them by the sway: the largest deflection of its slowest bending mode, hinged over the free
///   length l, with the motion of the handles as its base,
///
///     r'' = -w^2 r - p'',  w^2 = pi^4 D/(rho l^4) + g/l,
///     l = twice the largest distance of the paper from the nearest held point,
///
///   damped as the solver is. A sway of less than a quarter of the longer side is neglected: in
///   reality air holds paper back, which is not modelled. In a scene without gravity g is that of
///   the earth, so that accelerations which are small beside weight do not count there either.
///
/// first_frame, last_frame  of the scene, however much of it is simulated
InertiaNeed need_of_inertia(const Shot&, const ExternalForces&, double fps, int first_frame,
                            int last_frame);

}  // namespace paperbake
