#pragma once

#include "core/model/sheet.h"

#include <cstdint>

namespace paperbake {

/// Mixes the bits of a number. Random numbers made from it depend on their arguments alone, not on
/// the order of the calls. source [SplitMix64, Steele 2014]
std::uint64_t scramble(std::uint64_t);

/// A uniformly distributed number in [-1, 1).
double uniform(std::uint32_t seed, std::uint64_t index);

/// Two independent standard normal numbers.
Vector2d gaussian(std::uint32_t seed, std::uint32_t sheet, std::uint32_t event,
                  std::uint32_t attempt);

}  // namespace paperbake
