#pragma once

#include <string>

namespace paperbake {

/// How the texels of a map lie in the file.
/// scanline   rows from the top, ZIP in blocks of 16 rows: for compositing and for people
/// tiled_mip  64 x 64 tiles and halved levels down to 1 x 1, for renderers that read maps through a
///            texture cache
enum class MapLayout { scanline, tiled_mip };

/// What stands in the header of every map, as attributes of the file: frame (int), framesPerSecond
/// (rational), seed (int: the 32 bits of the seed), preset (string); and from the map itself
/// texelSize, foldWidth (what rolled paper is measured across) and creaseWidth (float, m). Nothing
/// that tells when, where or by whom.
struct MapInfo {
  int frame = 1;
  double fps = 24;
  unsigned seed = 0;
  std::string preset;
};

}  // namespace paperbake
