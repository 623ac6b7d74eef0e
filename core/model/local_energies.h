#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// What a sheet stores triangle by triangle, and where on the pattern its vertices would rather be.
struct LocalEnergies {
  Eigen::VectorXd membrane, bending;  // |T| [J]
  // |V|x2 [N] -dE/dX: how the energy falls when a vertex moves on the pattern while all vertices
  // stay where they are in space. Of a sheet in equilibrium it is the total derivative: a mesh
  // whose vertices follow it stores less.
  Points2 configurational_force;
};

}  // namespace paperbake
