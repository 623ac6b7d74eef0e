#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Forces on a sheet from outside that have a potential phi per unit of mass that does not depend
/// on time: gravity. It enters the incremental potential of a step in one sum with inertia
/// (incremental_potential.h):
///
///   E = sum_i m_i phi(x_i),   phi(x) = g z
///
/// The air is a term of its own (air_drag.h), because it depends on the velocity and the normal of
/// each triangle.
///
/// The functions stand in the header because a sum that is split over two calls rounds otherwise.
struct ExternalForces {
  double gravity = 0;  // [m/s2] along -z

  /// phi at each vertex. |V| [J/kg], an expression that refers to x
  auto potential(const Points3& x) const { return gravity * x.col(2); }
  /// d phi/dx, the same everywhere. 1x3 [N/kg]
  auto gradient() const { return gravity * Eigen::RowVector3d::UnitZ(); }
  // phi is linear: it has no second derivative

  /// E. mass |V| [kg], returns [J]
  double energy(const Eigen::VectorXd& mass, const Points3& x) const {
    return gravity * mass.dot(x.col(2));
  }
};

}  // namespace paperbake
