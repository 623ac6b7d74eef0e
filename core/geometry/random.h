#pragma once

#include "core/model/sheet.h"

#include <cstdint>

namespace paperbake {

/// Mixes the bits of a number. Random numbers made from it depend on their arguments alone, not on
/// the order of the calls. source [SplitMix64, Steele 2014]
std::uint64_t scramble(std::uint64_t);

/// A uniformly distributed number in [-1, 1).
double uniform(std::uint32_t seed, std::uint64_t index);

/// An event that is left to chance: its draws depend on these numbers alone.
struct RandomEvent {
  std::uint32_t seed, sheet, event;
};
/// Two independent standard normal numbers, of each draw others.
Vector2d gaussian(const RandomEvent&, std::uint32_t draw);

}  // namespace paperbake
