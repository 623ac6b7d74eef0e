#pragma once

#include "core/animation/animate.h"

#include <string>

namespace paperbake {

/// Whether inertia would change what a sheet looks like by more than the error of the method, and
/// why.
struct InertiaNeed {
  bool needed = false;
  double sway = 0;  // [1] of the longer side: how far handles would throw it, below
  std::string why;
};

/// Judged before anything is simulated, from start shape and handle curves alone: - under gravity,
/// a sheet that nothing holds falls; one that is held at a point or on a line swings, unless it
/// hangs below them from
///   the first frame on and they carry it by no more than 0.5 %: what is at rest there without
///   inertia is another shape altogether;
/// - a sheet that is held otherwise, or weighs nothing, is where its handles bend it. It lags
/// behind them by the sway: the largest
///   deflection of its slowest bending mode, hinged over the free length l, with the handles'
///   motion as its base
///     r'' = -w^2 r - p'',  w^2 = pi^4 D/(rho l^4) + g/l,  l = twice the farthest that paper is
///     from a held point,
///   damped as the solver is. Below a quarter of the sheet that is left to the air, which holds
///   paper back and is not modelled.
///   A scene without weight leaves out what is less than weight too: g is then that of the earth.
/// gravity  [m/s2] along -z
/// first_frame, last_frame  of the scene, however much of it is simulated
InertiaNeed need_of_inertia(const Shot&, double gravity, double fps, int first_frame,
                            int last_frame);

}  // namespace paperbake
