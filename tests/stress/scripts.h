#pragma once

#include "core/animation/animate.h"
#include "core/hands/handle_feasibility.h"

#include <cstdint>
#include <string>
#include <vector>

namespace paperbake::stress {

/// One generated shot. The same index and seed give the same shot.
struct Script {
  std::string kind;  // what is unusual about it
  Shot shot;
  AnimateOptions options;  // frames, time step, seed
  // pairs of handles that are asked to be farther apart than the paper between them is long
  std::vector<UnreachablePair> impossible;
};

/// Kinds of handle motion that no artist should key. They take turns, so that any hundred scripts
/// have every kind.
const std::vector<std::string>& kinds();

/// Sheets of 2 mm to 10 m: rectangles, discs, L shapes, sheets with a hole. 1 to 16 handles, 12 to
/// 40 frames.
Script make_script(int index, std::uint32_t seed);

}  // namespace paperbake::stress
