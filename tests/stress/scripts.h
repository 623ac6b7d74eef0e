#pragma once

#include "core/animate.h"
#include "core/reach.h"

#include <cstdint>
#include <string>
#include <vector>

namespace paperbake::stress {

/// One generated shot. The same index and seed give the same.
struct Script {
  std::string kind;         // what is odd about it
  Shot shot;
  AnimateOptions options;   // frames, time step, seed
  std::vector<ImpossiblePair> impossible;  // pairs of handles that are asked to be farther apart than paper between them is long
};

/// What handles may do that no artist should key: kinds in turn, so that any hundred scripts have every kind.
const std::vector<std::string>& kinds();

/// Sheets of 2 mm to 10 m: rectangles, discs, L shapes, sheets with a hole; 1 to 16 handles; 12 to 40 frames.
Script make_script(int index, std::uint32_t seed);

}  // namespace paperbake::stress
