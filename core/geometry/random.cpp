#include "core/geometry/random.h"

#include <cmath>

namespace paperbake {
namespace {

/// The upper 53 bits as a number in [0, 1).
double fraction(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

}  // namespace

std::uint64_t scramble(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

double uniform(std::uint32_t seed, std::uint64_t index) {
  return 2 * fraction(scramble((std::uint64_t(seed) << 32) + (index + 1) * 0x9e3779b97f4a7c15ull)) -
         1;
}

Vector2d gaussian(const RandomEvent& e, std::uint32_t draw) {
  std::uint64_t key = scramble((std::uint64_t(e.seed) << 32 | e.sheet) + 0x9e3779b97f4a7c15ull);
  key = scramble(key ^ (std::uint64_t(e.event) << 32 | draw));
  const double radius = std::sqrt(-2 * std::log(1 - fraction(scramble(key + 1)))),
               angle = 2 * M_PI * fraction(scramble(key + 2));
  return radius * Vector2d(std::cos(angle), std::sin(angle));
}

}  // namespace paperbake
