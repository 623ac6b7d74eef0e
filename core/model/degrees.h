#pragma once

#include <cmath>

namespace paperbake {

/// The same angle in radians and in degrees.
constexpr double radians_of(double degrees) { return degrees * M_PI / 180; }
constexpr double degrees_of(double radians) { return radians * 180 / M_PI; }

}  // namespace paperbake
