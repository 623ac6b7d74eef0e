#pragma once

#include "core/model/sheet.h"
#include "core/step1_elastic/contact/features.h"

#include <array>

namespace paperbake {

/// A barrier energy and its derivatives with respect to the distance d of two features.
struct Barrier {
  double value;   // [J]
  double slope;   // [N]    b'  <= 0
  double second;  // [N/m]  b'' >= 0
};

/// b(d) = -kappa (d - dhat)^2 ln(d/dhat)
/// d       [m] in (0, dhat)
/// kappa   [N/m]
/// source  [Li 2020], as a function of the distance itself
Barrier log_barrier(double d, double dhat, double kappa);

/// The barrier between two features of sheets: kappa = 0.05 N / dhat. Zero from dhat on; infinite
/// at 0.
Barrier barrier(double distance, double dhat);

/// Collision-free step of a pair of features: the fraction in [0, 1] of their moves that the four
/// corners may follow so that at least a fifth of their distance is left all along. The fraction is
/// smaller where it would take long to find. 0 for features that touch already.
/// source  [Li 2021], additive continuous collision detection; where a slab between the two
///         features allows larger steps, these are taken
double collision_free_step(const std::array<Vector3d, 4>& corners,
                           const std::array<Vector3d, 4>& moves, Features);

/// [m] Largest relative displacement of a corner of one feature and a corner of the other. The
/// features approach each other by no more than this.
double relative_move(const std::array<Vector3d, 4>& moves, Features);

}  // namespace paperbake
