#pragma once

#include "core/geometry/measure.h"
#include "formats/cache/alembic_cache.h"

namespace paperbake {

/// How well a frame of a cache keeps the lengths of the pattern, with its numbers rounded to 32
/// bits as the file has them: who reads the file finds the same.
/// longer_side  [m] of the pattern, which uv is in shares of
LengthDistortion cache_distortion(const CacheFrame&, double longer_side);

}  // namespace paperbake
