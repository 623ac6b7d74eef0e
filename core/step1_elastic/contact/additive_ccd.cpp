#include "core/step1_elastic/contact/additive_ccd.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double gap_kept = 0.2;  // [1] of a gap

/// What a step leaves of a gap. [m]
double gap_left(double gap) {
  // gap [m] that counts as tight, and the fraction [1] of it that is kept: it must not be used up
  // fifth by fifth
  constexpr double tight = 1e-7, tight_kept = 0.95;
  return std::max(gap_kept * gap, tight_kept * std::min(gap, tight));
}

/// Time in [0, 1] until the gap between two features along n has shrunk to `kept`. Along n their
/// corners move at constant speed, and those of one feature lie beyond those of the other, because
/// n joins the closest points.
double within_slab(const std::array<Vector3d, 4>& x, const std::array<Vector3d, 4>& moves,
                   const Vector3d& n, int second_feature, double kept) {
  double t = 1;
  for (int i = 0; i < second_feature; ++i)
    for (int j = second_feature; j < 4; ++j)
      if (const double rate = n.dot(moves[i] - moves[j]); rate < 0)
        t = std::min(t, (n.dot(x[i] - x[j]) - kept) / -rate);
  return t;
}

}  // namespace

bool is_certainly_free(double gap, double approach) {
  return gap > no_distance && gap - approach > gap_left(gap);
}

double relative_move(const std::array<Vector3d, 4>& moves, Features features) {
  double most = 0;
  for (int i = 0; i < second_of(features); ++i)
    for (int j = second_of(features); j < 4; ++j)
      most = std::max(most, (moves[i] - moves[j]).squaredNorm());
  return std::sqrt(most);
}

double collision_free_step(const std::array<Vector3d, 4>& corners,
                           const std::array<Vector3d, 4>& moves, Features features) {
  constexpr double of_the_way = 0.9;
  constexpr int max_steps = 60;
  const double speed = relative_move(moves, features);
  ClosestPoints near = closest_points(corners, features);
  double d = near.distance();
  if (speed == 0) return 1;
  if (d <= no_distance) return 0;
  if (is_certainly_free(d, speed)) return 1;
  const double kept = gap_left(d);
  double t = 0;
  std::array<Vector3d, 4> x = corners;
  for (int k = 0; k < max_steps; ++k) {
    const double step = of_the_way * (d - kept) / speed;
    if (!(step > 0)) return t;
    if (k > 0 && d - kept < 0.01 * gap_kept * d) return t;
    t += std::max(step, within_slab(x, moves, near.apart / d, second_of(features), kept));
    if (t >= 1) return 1;
    for (int i = 0; i < 4; ++i) x[i] = corners[i] + t * moves[i];
    near = closest_points(x, features);
    d = near.distance();
  }
  return t;
}

}  // namespace paperbake
