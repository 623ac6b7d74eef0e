#pragma once

#include "formats/files/certificate.h"

#include <optional>
#include <string>
#include <vector>

namespace paperbake {

constexpr double twin_jitter = 1e-6;  // [m] how far a twin is moved on each axis
// [1] RMS distance of a twin, in shares of the longer side, beyond which a frame is called chaotic:
// two hundred times the jitter on a letter, and a fifth of a millimetre
constexpr double twin_limit = 1e-3;

/// How a shot and its twin (baker/bake/twin.h) differ.
struct TwinVerdict {
  std::optional<int> chaotic_from;  // the first frame beyond the limit
  double largest = 0;               // [1] distance
  int frame_of_largest = 0;
};

/// Nothing: the frames have no twin.
std::optional<TwinVerdict> twin_verdict(const std::vector<FrameRecord>&);

std::string describe(const TwinVerdict&);

}  // namespace paperbake
