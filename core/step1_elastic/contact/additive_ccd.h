#pragma once

#include "core/model/sheet.h"
#include "core/step1_elastic/contact/features.h"

#include <array>

namespace paperbake {

// [m] Closer than this there is no direction from one feature to the other, only rounding.
inline constexpr double no_distance = 1e-12;

/// Collision-free step of a pair of features: the fraction in [0, 1] of their moves that the four
/// corners may follow so that at least a fifth of their distance is left all along. The fraction is
/// smaller where it would take long to find. 0 for features that touch already, to within
/// no_distance.
/// source  [Li 2021], additive continuous collision detection; where a slab between the two
///         features allows larger steps, these are taken
double collision_free_step(const std::array<Vector3d, 4>& corners,
                           const std::array<Vector3d, 4>& moves, Features);

/// True if collision_free_step() is certain to be 1.
/// gap       [m] that the features have at least
/// approach  [m] by which they come nearer to each other at most
bool is_certainly_free(double gap, double approach);

/// [m] Largest relative displacement of a corner of one feature and a corner of the other. The
/// features approach each other by no more than this.
double relative_move(const std::array<Vector3d, 4>& moves, Features);

}  // namespace paperbake
