#include "core/ripple.h"

#include "core/random.h"

#include <cmath>

namespace paperbake {

double ripple(const Vector2d& p, double side, unsigned seed) {
  constexpr int waves = 6;
  double sum = 0;
  for (int k = 0; k < waves; ++k) {
    const Vector2d direction(uniform(seed, 3 * k), uniform(seed, 3 * k + 1));
    sum += std::sin(2 * M_PI * (1.5 * direction.dot(p) / side + uniform(seed, 3 * k + 2))) / waves;
  }
  return sum;
}

}  // namespace paperbake
