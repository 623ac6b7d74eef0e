#pragma once

#include "core/pattern.h"
#include "core/sheet.h"

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// What stands in the header of every map, as attributes of the file:
/// frame (int), framesPerSecond (rational), seed (int: the 32 bits of the seed), preset (string); and from the map itself
/// texelSize (float, m) and foldWidth (float, m). Nothing that tells when, where or by whom.
struct MapInfo {
  int frame = 1;
  double fps = 24;
  unsigned seed = 0;
  std::string preset;
};

/// Crease and apex maps of one sheet as textures: a square of size x size texels over the render uv (pattern / longer side),
/// v up: texel (i, j) of the file, j counted from the top row, has its centre at u = (i+0.5)/size, v = 1 - (j+0.5)/size.
///
///   fold.angle  [rad] signed turn of the sheet across one fold width at this frame: k1 * fold_width, k1 the principal
///               curvature of larger magnitude of the vertex tensors, interpolated; > 0 where it bulges to its normal
///   fold.peak   [rad] the fold.angle of largest magnitude so far, with its sign; never smaller than |fold.angle|. Earlier
///               frames are remembered at a spacing of longer side / min(size, 256) and interpolated
///   apex.dist   [m]   distance to the nearest singular point so far; the sheet's diagonal where there is none
///
/// Texels outside the pattern carry the value of the nearest texel inside, up to 4 texels away (so that a texture lookup at
/// the border finds paper), else 0 (apex.dist: the diagonal). Texels inside that no triangle covers take the nearest value.
/// Angles are rounded to 2^-14 rad, distances to at most 1/8 texel.
class CreaseMap {
 public:
  /// size: texels on a side, at least 1. fold_width [m]: across what width a turn counts as one fold
  CreaseMap(const Pattern&, int size, double fold_width);

  /// To be called for every frame in order: remembers fold.peak. The sheet may be meshed anew between frames.
  /// vertex_curvature: |V|x3 [1/m], of core/curvature. throws Error(Fault::simulation) when it is not finite
  void record(const Sheet&, const Points3& vertex_curvature);

  /// The maps of the last recorded frame, whole or not at all; the same bytes at any thread count.
  /// throws Error(Fault::folder)
  void write(const std::filesystem::path&, const MapInfo&) const;

 private:
  struct Copy { int to, from; };   // texels, counted along the rows
  struct Grid {
    int size;                      // texels on a side
    std::vector<char> inside;      // is the texel's centre in the pattern?
    std::vector<Copy> padding;     // texels outside, with the nearest one inside
  };
  using Texels = std::vector<float>;

  static Grid make_grid(const Pattern&, int size);
  static std::vector<Copy> copies_from_nearest(const std::vector<char>& covered, const std::vector<char>& wanted, int size);

  Texels fold_angle(const Grid&) const;     // 0 outside
  Texels fold_peak(Texels angle) const;     // 0 outside
  Texels apex_distance() const;             // the diagonal outside
  std::string encode(const Texels& angle, const Texels& peak, const Texels& distance, const MapInfo&) const;

  double side_, diagonal_, fold_width_;     // [m]
  Grid fine_, coarse_;                      // of the file; of the memory between maps
  Texels peak_;                             // on coarse_
  Sheet last_;                              // of the last frame: pattern, triangles and singular only
  Points3 curvature_;                       // of the last frame
};

}  // namespace paperbake
