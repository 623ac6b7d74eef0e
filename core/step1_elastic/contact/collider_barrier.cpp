#include "core/step1_elastic/contact/collider_barrier.h"

#include <cmath>

namespace paperbake {

ColliderBarrier collider_barrier(double d) {
  // [N/m]; [m]; [m] where the polynomial begins
  constexpr double kappa = 200, reach = collider_dhat, first = 0.005 * reach;
  if (d >= reach) return {0, 0, 0};
  const auto at = [&](double s) -> ColliderBarrier {
    const double in = s - reach, logarithm = std::log(s / reach);
    return {-kappa * in * in * logarithm, -kappa * (2 * in * logarithm + in * in / s),
            -kappa * (2 * logarithm + 4 * in / s - in * in / (s * s))};
  };
  if (d >= first) return at(d);
  static const ColliderBarrier b = at(first);
  const double in = d - first;
  return {b.value + b.slope * in + 0.5 * b.second * in * in, b.slope + b.second * in, b.second};
}

}  // namespace paperbake
