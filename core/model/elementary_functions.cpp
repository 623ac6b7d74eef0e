#include "core/model/elementary_functions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// numbers that have more digits than a double, as sums; the first terms have so few digits that
// their products with small whole numbers are exact
constexpr double half_pi[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69,
                              0x1.b839a252049c1p-104};
constexpr double pi_high = 0x1.921fb54442d18p+1, pi_low = 0x1.1a62633145c07p-53;
constexpr double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;

/// sum_k c_k z^k
template <std::size_t n>
double polynomial(const double (&c)[n], double z) {
  double sum = c[n - 1];
  for (std::size_t k = n - 1; k-- > 0;) sum = sum * z + c[k];
  return sum;
}

// Taylor series: on the intervals used here the first term left out is below half a unit in the
// last place.
constexpr double of_sine[] = {
    -1.0 / 6,        1.0 / 120,        -1.0 / 5040,          1.0 / 362880,
    -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000};
constexpr double of_cosine[] = {
    1.0 / 24,        -1.0 / 720,         1.0 / 40320,          -1.0 / 3628800,
    1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000, -1.0 / 6402373705728000};
constexpr double of_arc_tangent[] = {-1.0 / 3, 1.0 / 5, -1.0 / 7, 1.0 / 9, -1.0 / 11, 1.0 / 13};
constexpr double of_exponential[] = {
    1.0 / 2,     1.0 / 6,      1.0 / 24,      1.0 / 120,      1.0 / 720,       1.0 / 5040,
    1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
constexpr double of_logarithm[] = {1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,  1.0 / 11,
                                   1.0 / 13, 1.0 / 15, 1.0 / 17, 1.0 / 19, 1.0 / 21};

struct SineCosine {
  double sine, cosine;
};

SineCosine sine_and_cosine(double x) {
  if (!std::isfinite(x)) return {not_a_number, not_a_number};
  constexpr double far = 1e6;  // beyond it the quarter turns are too many for the sum above
  if (std::abs(x) > far) x = std::fmod(x, 2 * pi_high);
  const double turns = std::nearbyint(x * 0x1.45f306dc9c883p-1);  // quarters
  double r = x - turns * half_pi[0], rest = turns * half_pi[1];
  const double first = r;
  r -= rest;
  // what the difference has lost, and the terms after it
  const double low = ((first - r) - rest) - turns * half_pi[2] - turns * half_pi[3];
  const double z = r * r;
  const double s = r + (r * z * polynomial(of_sine, z) + low * (1 - 0.5 * z)),
               c = 1 - (0.5 * z - (z * z * polynomial(of_cosine, z) - r * low));
  switch (static_cast<long long>(turns) & 3) {
    case 0:
      return {s + 0.0 * x, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

/// Arc tangent of a / b for 0 <= a <= b, as a sum.
struct TwoTerms {
  double high, low;
};
TwoTerms arc_tangent_of_ratio(double a, double b) {
  // of 0, 1/8 ... 1
  static constexpr TwoTerms of_eighths[] = {{0, 0},
                                            {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                            {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                            {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                            {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                            {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                            {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                            {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                            {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
  const double eighths = std::nearbyint(8 * (a / b));
  const TwoTerms& near = of_eighths[static_cast<int>(eighths)];
  const double t = (a - 0.125 * eighths * b) / (b + 0.125 * eighths * a), z = t * t;
  return {near.high, t + (t * z * polynomial(of_arc_tangent, z) + near.low)};
}

/// e^(high + low) for |low| much smaller than 1.
double exponential(double high, double low) {
  if (std::isnan(high)) return not_a_number;
  if (high > 710) return infinity;
  if (high < -746) return 0;
  const double twos = std::nearbyint(high * 0x1.71547652b82fep+0);
  const double r = (high - twos * ln2_high) - twos * ln2_low + low;
  return std::ldexp(1 + (r + r * r * polynomial(of_exponential, r)), static_cast<int>(twos));
}

/// mantissa * 2^twos, with a mantissa from root 1/2 to root 2
struct Scaled {
  double mantissa;
  int twos;
};

/// The parts of a finite positive number, read from its bits: std::frexp is a call into a library.
Scaled scaled(double x) {
  constexpr int mantissa_bits = 52, raised = 54;
  constexpr double root_half = 0.70710678118654752;
  int twos = 0;
  if (x < std::numeric_limits<double>::min()) {  // has no exponent of its own
    x = std::ldexp(x, raised);
    twos = -raised;
  }
  std::int64_t bits, least;
  std::memcpy(&bits, &x, sizeof x);
  std::memcpy(&least, &root_half, sizeof root_half);
  const std::int64_t exponent = (bits - least) >> mantissa_bits;
  bits -= exponent * (std::int64_t{1} << mantissa_bits);
  std::memcpy(&x, &bits, sizeof x);
  return {x, twos + static_cast<int>(exponent)};
}

/// Logarithm of a finite positive number.
TwoTerms logarithm(double x) {
  const auto [m, twos] = scaled(x);
  // log m = 2 artanh s = f - f^2/2 + s (f^2/2 + 2 s^2 (1/3 + ...)), f = m - 1
  const double f = m - 1, s = f / (2 + f), z = s * s, half_square = 0.5 * f * f;
  const double rest = s * (half_square + 2 * z * polynomial(of_logarithm, z)) + twos * ln2_low;
  const double high = twos * ln2_high + f;
  const double lost = (twos * ln2_high - high) + f;
  return {high, lost - (half_square - rest)};
}

/// 0: even, 1: odd, -1: not whole
int parity(double y) {
  if (y != std::trunc(y)) return -1;
  return std::fmod(y, 2) != 0;
}

}  // namespace

double paperbake_sin(double x) { return x == 0 ? x : sine_and_cosine(x).sine; }
double paperbake_cos(double x) { return sine_and_cosine(x).cosine; }
void paperbake_sincos(double x, double* sine, double* cosine) {
  const SineCosine both = sine_and_cosine(x);
  *sine = x == 0 ? x : both.sine;
  *cosine = both.cosine;
}
double paperbake_tan(double x) {
  if (x == 0) return x;
  const SineCosine both = sine_and_cosine(x);
  return both.sine / both.cosine;
}

double paperbake_atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return not_a_number;
  const double up = std::abs(y), across = std::abs(x);
  double a = std::min(up, across), b = std::max(up, across);
  if (std::isinf(b)) {
    a = std::isinf(a);
    b = 1;
  } else if (b > 0x1p1000) {  // the sum of both must be finite
    a *= 0x1p-8;
    b *= 0x1p-8;
  }
  const TwoTerms of_ratio = b > 0 ? arc_tangent_of_ratio(a, b) : TwoTerms{0, 0};
  double high = of_ratio.high, low = of_ratio.low;
  if (up > across) {  // seen from the other axis
    high = 0.5 * pi_high - high;
    low = 0.5 * pi_low - low;
  }
  if (std::signbit(x)) {
    high = pi_high - high;
    low = pi_low - low;
  }
  return std::copysign(high + low, y);
}
double paperbake_atan(double x) { return x == 0 ? x : paperbake_atan2(x, 1); }
double paperbake_asin(double x) {
  return x == 0 ? x : paperbake_atan2(x, std::sqrt((1 - x) * (1 + x)));
}
double paperbake_acos(double x) { return paperbake_atan2(std::sqrt((1 - x) * (1 + x)), x); }

double paperbake_exp(double x) { return exponential(x, 0); }

double paperbake_log(double x) {
  if (std::isnan(x) || x < 0) return not_a_number;
  if (x == 0) return -infinity;
  if (std::isinf(x)) return x;
  const TwoTerms sum = logarithm(x);
  return sum.high + sum.low;
}

double paperbake_pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y)) return not_a_number;
  const double size = std::abs(x);
  if (std::isinf(y)) return size == 1 ? 1 : (size > 1) == (y > 0) ? infinity : 0;
  const bool negative = std::signbit(x) && parity(y) == 1;
  const auto with_sign = [&](double power) { return negative ? -power : power; };
  if (size == 0 || std::isinf(size)) return with_sign((size == 0) == (y < 0) ? infinity : 0.0);
  if (x < 0 && parity(y) < 0) return not_a_number;
  const TwoTerms log = logarithm(size);
  const double sum = log.high + log.low, left = (log.high - sum) + log.low;
  const double high = y * sum, low = std::fma(y, sum, -high) + y * left;
  return with_sign(std::abs(high) > 800 ? exponential(high, 0) : exponential(high, low));
}
