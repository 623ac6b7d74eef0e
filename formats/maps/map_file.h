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

/// All layers of a map at one texel, in the types of the file; see crease_map.h for what they mean.
struct MapTexel {
  half r{0.0f}, g{0.0f}, b{0.0f}, a{0.0f};
  float dihedral_angle = 0, fold_plastic = 0, fold_peak = 0;
  float age_crease = -1, age_apex = -1;
  float apex_dist = 0, apex_cone = 0;
  std::uint32_t apex_id = 0;
  float dir_x = 0, dir_y = 0;
  float strain_min = 0, strain_max = 0;
};

/// What the header says beside MapInfo. [m]
struct MapScale {
  double texel = 0, fold_width = 0, crease_width = 0;
};

/// Fills the texels of some rows, row after row; it is called for several strips of rows at once.
using DrawRows = std::function<void(const MapRows&, MapTexel*)>;

/// The bytes of an OpenEXR file with the layers that `draw` draws; the same ones at any number of
/// threads.
///
/// scanline   drawn and packed a strip at a time, 14 MB of texels at 2048
/// tiled_mip  all levels are in memory at once, 75 bytes for each texel of the largest
///
/// threads  1: none but the caller's
std::string encode_map(int size, MapLayout, const MapInfo&, const MapScale&, int threads,
                       const DrawRows& draw);

/// The next level of a map: each side floor(size / 2), at least 1. Masks and data are means over
/// the area of the texels under the new one, weighted by how much pattern lies in them (A: over all
/// of the area); age.crease over those that have a crease; directions as lines without a head.
/// apex.id, apex.cone and age.apex are those of one texel, next to the new one's centre.
/// threads  at least 1; the texels do not depend on them
std::vector<MapTexel> next_level(const std::vector<MapTexel>&, int size, int threads);

}  // namespace paperbake
