#pragma once

#include "formats/maps/map_fields.h"

namespace paperbake {

/// Remembers the fold.angle of largest magnitude that each place of a pattern has seen, on a grid
/// of at most 512 texels along the longer side. A fold is at least 2 % of the sheet wide, ten of
/// these texels: what it looks like between them is not lost.
class FoldPeak {
 public:
  /// size: texels on a side of the maps; loops: corners of the pattern over `side` [m], in pattern
  /// coordinates [m]
  FoldPeak(const std::vector<std::vector<Vector2d>>& loops, double side, int size);

  void record(const MapFields&);

  /// The peak between the texels of the memory, for a row of a map of `size` texels. [rad]
  std::vector<float> row(int row, int size) const;

 private:
  double side_;
  MapRows rows_;
  std::vector<std::vector<Vector2d>> loops_;  // [texel]
  std::vector<char> wanted_;
  // Both principal values are continuous on a sheet, the larger one of them is not where its sign
  // flips. So the largest of each is remembered and interpolated, and which of them is the peak is
  // decided at the texel of the map: no stairs, no line of zero.
  std::vector<float> bulge_, hollow_;  // [rad] at least 0
};

}  // namespace paperbake
