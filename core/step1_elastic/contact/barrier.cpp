#include "core/step1_elastic/contact/barrier.h"

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

}  // namespace paperbake
