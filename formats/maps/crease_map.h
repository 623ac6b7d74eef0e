#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "formats/files/raster_image.h"
#include "formats/maps/crease_history.h"
#include "formats/maps/map_info.h"

#include <filesystem>
#include <memory>

namespace paperbake {

struct CreaseMapOptions {
  int size = 1024;  // texels on a side, at least 1
  // [m] across what width a turn of rolled paper counts as one fold
  double fold_width = 0.002;
  // [m] of the lines of R; never drawn thinner than 1.5 texel
  double crease_width = 0.0005;
  CreaseThresholds thresholds;
  MapLayout layout = MapLayout::scanline;
  int threads = 1;  // the bytes do not depend on them
};

/// DetectedCrease and apex maps of one sheet as textures: a square of size x size texels over the render uv
/// (pattern / longer side), v up: texel (i, j) of the file, j counted from the top row, has its
/// centre at u = (i+0.5)/size, v = 1 - (j+0.5)/size.
///
/// R, G, B and A are HALF, apex.id is UINT, everything else FLOAT. "So far": in any recorded frame
/// up to this one.
///
///   R            [0, 1] crease strength: the largest |fold angle| so far of the creases that run
///   through here, over a right
///                angle; lines of creaseWidth, anti-aliased. What counts as a crease:
///                crease_history.h
///   G            [0, 1] apex mask: a disc of radius creaseWidth around every singular point so far
///   B            [0, 1] curved one way at this frame, as a cone is: 0 where |k1| x longer side is
///   under 0.18 rad (flat) or
///                |k2/k1| above 0.7 (crumpled), 1 above 0.3 rad and below 0.5
///   A            [0, 1] coverage: how much of the texel is pattern, exactly. R, G and B are not
///   multiplied by it
///   fold.angle   [rad] signed turn of the sheet at this frame, > 0 where it bulges to its normal,
///   in [-pi, pi]. On a crease of the
///                mesh its dihedral angle, falling to 0 where the mesh is flat beside it; where
///                paper is rolled, the turn across one
///                foldWidth: principal curvature of larger magnitude x foldWidth. Between the two
///                as fold_width.h says, at the
///                vertices; tensors are interpolated
///   fold.plastic [rad] the same of the curvature that the paper has kept: what it would spring
///   back to; 0 without plasticity
///   fold.peak    [rad] the fold.angle of largest magnitude so far, with its sign; never smaller
///   than |fold.angle|
///   age.crease   [s]   since the first crease that runs through here appeared; -1 where there is
///   none. Reaches 1.5 texels beyond
///                the lines of R, so that a filtered lookup under R never meets the -1
///   age.apex     [s]   since the birth of the nearest singular point; -1 where there is none
///   apex.dist    [m]   distance to the nearest singular point so far; the sheet's diagonal where
///   there is none
///   apex.id      [1]   number of that point among those of its sheet, in order of birth, from 1:
///   for a shot of one sheet, its id
///                in singular.csv; 0 where there is none. Never filtered
///   apex.cone    [rad] turn of the sheet about that point at this frame: sum of |fold angle| over
///   the mesh edges that meet there;
///                0 where it lies flat, or where there is none
///   dir.x, dir.y [1]   unit direction of the ruling on the pattern (x right, v up), x >= 0; (0, 0)
///   where it is flat, as for B. A
///                line has no head: filter (x^2 - y^2, 2 x y), as the levels of tiled_mip are
///   strain.min, strain.max  [%] smallest and largest principal stretch - 1 at this frame, averaged
///   over the triangles around each
///                vertex and interpolated; < 0 where shortened
///
/// Texels outside the pattern, up to 4 texels away from it, continue it (so that a texture lookup
/// at the border finds paper): A is 0, the shape is that of the nearest point of the border. Beyond
/// them every layer is 0 or what says "none" above. Angles are rounded to 2^-12 rad, strains to
/// 2^-12 %, directions to 2^-10, distances to at most 1/8 texel.
class CreaseMap {
 public:
  CreaseMap(const Pattern&, const CreaseMapOptions&);
  ~CreaseMap();

  /// To be called for every frame in order: remembers creases and fold.peak. The sheet may be
  /// meshed anew between frames.
  /// curvature  |V|x3 [1/m], of core/curvature
  /// plastic    |V|x3 [1/m], what the paper has kept of it; empty without plasticity
  /// throws Error(Fault::simulation) when one of them is not finite
  void record(int frame, const Sheet&, const Points3& curvature, const Points3& plastic = {});

  /// The map of the last recorded frame with the history of all of them, whole or not at all. Ages
  /// are up to info.frame. throws Error(Fault::folder)
  void write(const std::filesystem::path&, const MapInfo&) const;

  /// The same to look at, at most 1024 px: the pattern with its creases so far, red where they
  /// bulge to the normal and blue where away from it, and its singular points.
  Image picture(const MapInfo&) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace paperbake
