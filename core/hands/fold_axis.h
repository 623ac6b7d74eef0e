#pragma once

#include "core/hands/clamps.h"
#include "core/model/degrees.h"

#include <optional>
#include <vector>

namespace paperbake {

/// A straight line on the pattern about which one clamp turns against another.
struct FoldAxis {
  Vector2d point, direction;  // [m], of length 1
  std::vector<double> turn;   // [rad] as in FoldingHands
  Vector2d between{0, 0};     // [m] a point of the pattern between the two clamps
  double reach = 0;           // [m] distance of their middles
  const Clamp *plate = nullptr, *other = nullptr;

  /// [m] Distance of a point of the pattern from the line, positive on its left.
  double side(const Vector2d& p) const;
};

// [1] of the longer side: handles this near to a line are on it
inline constexpr double on_line = 5e-3;
// [rad] hands that turn against each other by less do not fold the paper
inline constexpr double min_fold_turn = radians_of(60);

/// The axis about which a clamp turns against a plate by at least 60 degrees; none if there is
/// none, or if the clamp is on both sides of it, or on the same one as the plate. The formulas are
/// in expected_creases.h.
std::optional<FoldAxis> fold_axis(const Clamps&, const Clamp& plate, const Clamp& other);

}  // namespace paperbake
