#pragma once

#include <string>

namespace paperbake {

/// The arrangement of the texels in the file of a map.
/// scanline   rows from the top, ZIP in blocks of 16 rows: for compositing and for viewing
/// tiled_mip  64 x 64 tiles, and levels of half the size down to 1 x 1: for renderers with a
///            texture cache
enum class MapLayout { scanline, tiled_mip };

/// Attributes in the header of a map: frame (int), framesPerSecond (rational), seed (int: the 32
/// bits of the seed) and preset (string). The file has texelSize, foldWidth and creaseWidth (float,
/// m) in addition, but no date, host name or user name.
struct MapInfo {
  int frame = 1;
  double fps = 24;
  unsigned seed = 0;
  std::string preset;
};

}  // namespace paperbake
