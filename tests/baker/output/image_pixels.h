#pragma once

#include "formats/files/raster_image.h"

#include <algorithm>
#include <functional>

namespace paperbake::test {

/// How many pixels of an image have a colour that is wanted.
inline int count(const Image& image, const std::function<bool(const Colour&)>& wanted) {
  return static_cast<int>(std::count_if(image.pixels.begin(), image.pixels.end(), wanted));
}

inline bool orange(const Colour& c) { return c == Colour{240, 130, 0}; }  // jammed handles

}  // namespace paperbake::test
