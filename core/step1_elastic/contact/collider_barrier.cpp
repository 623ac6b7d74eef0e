#include "core/step1_elastic/contact/collider_barrier.h"

namespace paperbake {

Barrier collider_barrier(double d) {
  // [N/m]; [m]; [m] where the polynomial begins
  constexpr double kappa = 200, reach = collider_dhat, first = 0.005 * reach;
  if (d >= reach) return {0, 0, 0};
  if (d >= first) return log_barrier(d, reach, kappa);
  static const Barrier b = log_barrier(first, reach, kappa);
  const double in = d - first;
  return {b.value + b.slope * in + 0.5 * b.second * in * in, b.slope + b.second * in, b.second};
}

}  // namespace paperbake
