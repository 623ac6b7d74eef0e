#include "core/step1_elastic/contact/barrier.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace paperbake {

Barrier log_barrier(double d, double dhat, double kappa) {
  const double in = d - dhat, logarithm = std::log(d / dhat);
  return {-kappa * in * in * logarithm, -kappa * (2 * in * logarithm + in * in / d),
          -kappa * (2 * logarithm + 4 * in / d - in * in / (d * d))};
}

Barrier barrier(double d, double dhat) {
  if (d >= dhat) return {0, 0, 0};
  if (d <= 0) return {std::numeric_limits<double>::infinity(), 0, 0};
  return log_barrier(d, dhat, 0.05 / dhat);
}

double relative_move(const std::array<Vector3d, 4>& moves, Features features) {
  double most = 0;
  for (int i = 0; i < second_of(features); ++i)
    for (int j = second_of(features); j < 4; ++j)
      most = std::max(most, (moves[i] - moves[j]).squaredNorm());
  return std::sqrt(most);
}

/// Time in [0, 1] until the gap between two features along n has shrunk to `kept`. Along n their
/// corners move at constant speed, and those of one feature lie beyond those of the other, because
/// n joins the closest points.
static double within_slab(const std::array<Vector3d, 4>& x, const std::array<Vector3d, 4>& moves,
                          const Vector3d& n, int second_feature, double kept) {
  double t = 1;
  for (int i = 0; i < second_feature; ++i)
    for (int j = second_feature; j < 4; ++j)
      if (const double rate = n.dot(moves[i] - moves[j]); rate < 0)
        t = std::min(t, (n.dot(x[i] - x[j]) - kept) / -rate);
  return t;
}

double collision_free_step(const std::array<Vector3d, 4>& corners,
                           const std::array<Vector3d, 4>& moves, Features features) {
  constexpr double gap_kept = 0.2, of_the_way = 0.9;
  // gap [m] that counts as tight, and the fraction [1] of it that is kept: it must not be used up
  // fifth by fifth
  constexpr double tight = 1e-7, tight_kept = 0.95;
  constexpr int max_steps = 60;
  const double speed = relative_move(moves, features);
  ClosestPoints near = closest_points(corners, features);
  double d = near.distance();
  const double kept = std::max(gap_kept * d, tight_kept * std::min(d, tight));
  if (speed == 0 || d - speed > kept) return 1;
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
