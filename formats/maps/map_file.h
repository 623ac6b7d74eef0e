#pragma once

#include "formats/maps/map_info.h"
#include "formats/maps/map_raster.h"

#include <ImathConfig.h>
#include <half.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// All layers of a map at one texel, in the types of the file; crease_map.h describes them.
struct MapTexel {
  half r{0.0f}, g{0.0f}, b{0.0f}, a{0.0f};
  half fold_angle{0.0f}, fold_plastic{0.0f}, fold_peak{0.0f};
  half age_crease{-1.0f}, age_apex{-1.0f};
  half apex_dist{0.0f}, apex_cone{0.0f};
  half dir_x{0.0f}, dir_y{0.0f};
  half strain_min{0.0f}, strain_max{0.0f};
  std::uint32_t apex_id = 0;
};

/// Lengths in the header of the file, in addition to MapInfo. [m]
struct MapScale {
  double texel = 0, fold_width = 0, crease_width = 0;
};

/// Fills the texels of some rows, row after row. Called for several strips of rows concurrently.
using DrawRows = std::function<void(const MapRows&, MapTexel*)>;

/// The bytes of an OpenEXR file with the layers that `draw` fills; they do not depend on the number
/// of threads.
///
/// scanline   drawn and compressed strip by strip: 2 MB of texels at size 2048 with two threads
/// tiled_mip  all levels are in memory at once: 48 bytes for each texel of the largest level
///
/// threads  1: only that of the caller
std::string encode_map(int size, MapLayout, const MapInfo&, const MapScale&, int threads,
                       const DrawRows& draw);

/// The next level of a mip-map: each side is floor(size / 2), at least 1. A new texel is the mean
/// of the texels that it covers, weighted by the part of the pattern in them (A: by their area);
/// age.crease is averaged over those with a crease, directions as rulings without orientation.
/// apex.id, apex.cone and age.apex are taken from the texel next to the centre.
/// threads  at least 1; no influence on the texels
std::vector<MapTexel> next_level(const std::vector<MapTexel>&, int size, int threads);

}  // namespace paperbake
