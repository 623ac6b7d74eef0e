#include "baker/output/cache_measure.h"

namespace paperbake {

LengthDistortion cache_distortion(const CacheFrame& frame, double longer_side) {
  Sheet stored;
  stored.x = frame.x.cast<float>().cast<double>();
  stored.pattern = longer_side * frame.uv.cast<float>().cast<double>();
  stored.triangles = frame.triangles;
  return length_distortion(stored);
}

}  // namespace paperbake
