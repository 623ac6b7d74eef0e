#pragma once

#include "core/linear_algebra/block_cholesky.h"
#include "core/model/air.h"
#include "core/model/sheet.h"

#include <array>
#include <vector>

namespace paperbake {

/// What the air does to a sheet in one step, triangle by triangle:
///
///   F = -K u,   K = rho/2 A |u0| (C_d p n n^T + C_f (I - n n^T)),   W = dt/2 u^T K u
///
/// u    [m/s] velocity of the triangle against the air, (x - x0)/dt - air, at its centre
/// u0   [m/s] the same at the beginning of the step
/// n    unit normal at the beginning of the step;  A [m2] area on the pattern
/// C_d  1.2: a plate across the wind. With the normal force C_d sin(alpha), alpha the angle between
///      the plate and the wind, the plate has drag C_d sin^2 and lift C_d sin cos
/// C_f  2 * 1.328 / sqrt(Re): friction along the sheet, laminar, both sides. Re is that of the mean
///      speed against the air and of the length of the sheet in its direction, at least 100.
///      0.023 at 1 m/s and 0.2 m
/// p    [1] the pressure is higher near the leading edge of a plate that meets the air at a small
///      angle, which is what makes paper flutter and tumble:
///        p = sin(alpha) + (1 - sin(alpha)) sqrt((1 - c)/c) 2/pi,
///      c the way along the wind from the leading edge, of the whole, with mean 1 over the sheet.
///      The centre of pressure of a plate is at a quarter of its depth for a small angle, and in
///      its middle across the wind.
///
/// K is taken at the beginning of the step and u at its end, so W is a convex quadratic function of
/// the positions, and in still air its force never does work on the sheet: F u = -u^T K u <= 0.
/// source  [Hoerner 1965] for C_d and the centre of pressure; [Blasius 1908] for C_f; the pressure
///         of a thin plate at a small angle is that of potential flow
class AirDrag {
 public:
  /// The air around a sheet at the beginning of a step.
  /// dt    [s] length of the step
  /// time  [s] at its end, since the first frame
  AirDrag(const Air&, const Sheet&, double dt, double time);

  double energy(const Points3& x) const;  // [J]
  /// Returns the energy [J]. Adds its gradient [N] to `gradient` and its Hessian [N/m], which is
  /// never indefinite, to the matrix.
  double differentiate(const Points3& x, const std::vector<int>& block_of, Points3& gradient,
                       BlockCholesky&) const;

 private:
  struct Panel {
    std::array<int, 3> vertices;
    Vector3d from;             // [m] where its centre would be at the end if it moved with the air
    Eigen::Matrix3d per_step;  // K/dt [N/m]
  };
  Vector3d through_air(const Panel&, const Points3& x) const;
  std::vector<Panel> panels_;
};

}  // namespace paperbake
