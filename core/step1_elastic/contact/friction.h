#pragma once

#include "core/geometry/proximity.h"
#include "core/step1_elastic/contact/features.h"

#include <array>

namespace paperbake {

/// Friction mollifier: the energy that a contact dissipates when it slides by y, divided by
/// friction coefficient x normal force, and its derivatives.
///
///   f0(y) = y from epsilon on, -y^3/(3 epsilon^2) + y^2/epsilon + epsilon/3 below
///
/// source  [Li 2020]
struct FrictionMollifier {
  double value;   // [m]
  double slope;   // [1]
  double second;  // [1/m]
};
FrictionMollifier friction_mollifier(double slip, double epsilon);

/// The same for a displacement in a plane. The gradient is across * displacement; the Hessian is
/// never indefinite.
struct FrictionMollifierInPlane {
  double value;            // [m]
  double across;           // [1/m] slope / |displacement|
  Eigen::Matrix2d second;  // [1/m]
};
FrictionMollifierInPlane friction_mollifier(const Eigen::Vector2d& slip, double epsilon);

/// Two orthogonal directions across a unit normal.
Eigen::Matrix<double, 3, 2> tangents_of(const Vector3d& normal);

/// How a pair of features at x slides along each other when its corners move: by sum_i along_i
/// move_i [m] in the tangents_of its normal. To first order a rigid motion is no sliding (see
/// sheet_contact.h).
/// near  the closest points of the features, which do not touch
std::array<Eigen::Matrix<double, 2, 3>, 4> sliding_map(const std::array<Vector3d, 4>& x, Features,
                                                       const ClosestPoints& near);

}  // namespace paperbake
