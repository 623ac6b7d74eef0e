#include "core/model/elementary_functions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace paperbake {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const double nan_value = std::numeric_limits<double>::quiet_NaN();

/// How far a value is from the exact one, in units of its last place.
double units(double value, long double exact) {
  const double size = std::abs(static_cast<double>(exact));
  return static_cast<double>(std::abs(value - exact)) / (std::nextafter(size, infinity) - size);
}

constexpr double allowed = 3;  // [units in the last place]
constexpr int draws = 20000;

TEST(ElementaryFunctions, AnglesAreExactToThreeUnits) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-1, 1);
  for (int k = 0; k < draws; ++k) {
    const double x = share(random) * std::pow(10.0, 5 * share(random)), c = share(random),
                 y = share(random) * std::pow(10.0, 9 * share(random));
    double sine, cosine;
    paperbake_sincos(x, &sine, &cosine);
    ASSERT_LT(units(sine, std::sin(static_cast<long double>(x))), allowed) << x;
    ASSERT_LT(units(cosine, std::cos(static_cast<long double>(x))), allowed) << x;
    ASSERT_EQ(sine, paperbake_sin(x));
    ASSERT_EQ(cosine, paperbake_cos(x));
    ASSERT_LT(units(paperbake_tan(x), std::tan(static_cast<long double>(x))), allowed) << x;
    ASSERT_LT(units(paperbake_atan(x), std::atan(static_cast<long double>(x))), allowed) << x;
    ASSERT_LT(units(paperbake_asin(c), std::asin(static_cast<long double>(c))), allowed) << c;
    ASSERT_LT(units(paperbake_acos(c), std::acos(static_cast<long double>(c))), allowed) << c;
    ASSERT_LT(units(paperbake_atan2(y, x), std::atan2(static_cast<long double>(y), x)), allowed)
        << y << ' ' << x;
  }
}

TEST(ElementaryFunctions, PowersAndLogarithmsAreExactToThreeUnits) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> share(-1, 1);
  for (int k = 0; k < draws; ++k) {
    const double x = 700 * share(random), base = std::exp(x),
                 near_one = 1 + 0.5 * share(random) * std::pow(10.0, 8 * share(random) - 8),
                 small = std::exp(5 * share(random)), power = 10 * share(random);
    ASSERT_LT(units(paperbake_exp(x), std::exp(static_cast<long double>(x))), allowed) << x;
    ASSERT_LT(units(paperbake_log(base), std::log(static_cast<long double>(base))), allowed);
    ASSERT_LT(units(paperbake_log(near_one), std::log(static_cast<long double>(near_one))), allowed)
        << near_one;
    ASSERT_LT(units(paperbake_pow(small, power), std::pow(static_cast<long double>(small), power)),
              allowed)
        << small << ' ' << power;
  }
}

TEST(ElementaryFunctions, ZerosInfinitiesAndWhatIsNotANumberAreThoseOfTheCLibrary) {
  const double values[] = {0.0, -0.0, 1, -1, 0.5, -2, 3, infinity, -infinity, nan_value, 5e-324};
  const auto same = [](double a, double b) {
    if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
    return std::signbit(a) == std::signbit(b) && (a == b || std::abs(a - b) < 1e-15 * std::abs(b));
  };
  for (const double x : values) {
    EXPECT_TRUE(same(paperbake_sin(x), std::sin(x))) << x;
    EXPECT_TRUE(same(paperbake_cos(x), std::cos(x))) << x;
    EXPECT_TRUE(same(paperbake_tan(x), std::tan(x))) << x;
    EXPECT_TRUE(same(paperbake_asin(x), std::asin(x))) << x;
    EXPECT_TRUE(same(paperbake_acos(x), std::acos(x))) << x;
    EXPECT_TRUE(same(paperbake_atan(x), std::atan(x))) << x;
    EXPECT_TRUE(same(paperbake_exp(x), std::exp(x))) << x;
    EXPECT_TRUE(same(paperbake_log(x), std::log(x))) << x;
    for (const double y : values) {
      EXPECT_TRUE(same(paperbake_atan2(y, x), std::atan2(y, x))) << y << ' ' << x;
      EXPECT_TRUE(same(paperbake_pow(x, y), std::pow(x, y))) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace paperbake
