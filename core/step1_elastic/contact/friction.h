#pragma once

#include "core/geometry/proximity.h"

#include <array>

namespace paperbake {

/// What dissipates while a contact slides by y, divided by friction x force.
///
///   f0(y) = y from epsilon on, -y^3/(3 epsilon^2) + y^2/epsilon + epsilon/3 below
///
/// source  [Li 2020]
struct FrictionMollifier {
  double value;   // [m]
  double slope;   // [1]
  double second;  // [1/m]
};
FrictionMollifier friction_mollifier(double way, double epsilon);

/// The same of a way in a plane: its gradient is across * way; the second derivative is never
/// indefinite.
struct FrictionMollifierInPlane {
  double value;            // [m]
  double across;           // [1/m] slope / |way|
  Eigen::Matrix2d second;  // [1/m]
};
FrictionMollifierInPlane friction_mollifier(const Eigen::Vector2d& way, double epsilon);

/// How a pair of features at x slides along itself, by the moves of its corners: sum_i along_i
/// move_i [m]; by no rigid move, to first order. (self_contact.h)
/// edges, near  two edges 0-1 and 2-3, else vertex 0 and triangle 1-2-3; what is nearest, not
///              touching
std::array<Eigen::Matrix<double, 2, 3>, 4> sliding_map(const std::array<Vector3d, 4>& x, bool edges,
                                                       const ClosestPoints& near);

// [m/s] what slides slower than that sticks: epsilon = creep dt
inline constexpr double static_speed_bound = 1e-4;

}  // namespace paperbake
