#pragma once

#include "formats/maps/map_fields.h"

namespace paperbake {

/// Accumulates the fold.angle of largest magnitude so far for each place of a pattern, on a grid of
/// at most 512 texels along the longer side. That is fine enough: a fold is at least 2 % of the
/// sheet wide, which is ten of these texels.
class FoldPeak {
 public:
  /// loops  corners of the pattern's outline and holes [m]
  /// size   texels on a side of the maps
  FoldPeak(const std::vector<std::vector<Vector2d>>& loops, const FoldScale&, int size);

  /// Takes a frame into account.
  void record(const MapFields&);

  /// The peak for each texel of these rows of a map, interpolated on the grid. [rad]
  std::vector<float> peaks(const MapRows&) const;

 private:
  FoldScale scale_;
  MapRows rows_;
  std::vector<std::vector<Vector2d>> loops_;  // [texel]
  struct Band {                               // rows of the grid that stay in the cache together
    MapRows rows;
    std::vector<char> wanted;
  };
  std::vector<Band> bands_;
  // Both principal values are continuous on a sheet, but the one of larger magnitude is not where
  // its sign changes. So the maximum of each is stored and interpolated, and which of them is the
  // peak is decided for each texel of the map: interpolating the peak itself would give stairs and
  // lines of zeros.
  // [rad] >= 0, towards the normal and away from it; with room for a padded row behind the last one
  std::vector<float> bulge_, hollow_;
};

}  // namespace paperbake
