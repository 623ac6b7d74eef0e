#pragma once

#include "core/model/sheet.h"

#include <array>

namespace paperbake {

/// The barrier between two features and its derivatives by their distance d. Zero from `reach` on;
/// infinite at 0.
///
///   b(d) = -kappa (d - d^)^2 ln(d/d^),   kappa = 50 N/m
///
/// source  [Li 2020], of the distance itself
struct Barrier {
  double value;   // [J]
  double slope;   // [N]    b'  <= 0
  double second;  // [N/m]  b'' >= 0
};
Barrier barrier(double distance, double dhat);

/// How far the four corners of a pair may follow their moves, as a share in [0, 1], so that a fifth
/// of their distance is left all the way; less than that where finding it would take long. Corners
/// that touch already: 0.
/// edges   two edges 0-1 and 2-3; else vertex 0 and triangle 1-2-3
/// source  [Li 2021], additive continuous collision detection; a slab between the two where that
///         lets them slide farther
double collision_free_step(const std::array<Vector3d, 4>& corners,
                           const std::array<Vector3d, 4>& moves, bool edges);

/// The largest distance that a corner of one feature moves against one of the other: they come
/// nearer by no more. [m]
double relative_move(const std::array<Vector3d, 4>& moves, bool edges);

}  // namespace paperbake
