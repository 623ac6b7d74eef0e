#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "formats/files/raster_image.h"
#include "formats/maps/crease_history.h"
#include "formats/maps/map_info.h"

#include <filesystem>
#include <memory>
#include <string>

namespace paperbake {

struct CreaseMapOptions {
  int size = 1024;  // texels on a side, at least 1
  // [m] width across which the turn of rolled paper is measured as one fold
  double fold_width = 0.002;
  // [m] width of the lines of R; never drawn thinner than 1.5 texels
  double crease_width = 0.0005;
  CreaseThresholds thresholds;
  MapLayout layout = MapLayout::scanline;
  int threads = 1;  // no influence on the bytes
};

/// Crease and apex maps of one sheet as textures: a square of size x size texels over the render uv
/// (pattern / longer side), v up. Texel (i, j) of the file, j counted from the top row, has its
/// centre at u = (i+0.5)/size, v = 1 - (j+0.5)/size.
///
/// The layers (HALF, which has more than three digits, but for apex.id, which is UINT; "so far"
/// means in any recorded frame up to this one):
///
///   R            [0, 1] crease strength: the largest dihedral angle so far of the creases that run
///                through the texel, over a right angle. Drawn as anti-aliased lines of
///                creaseWidth. What counts as a crease: crease_history.h
///   G            [0, 1] apex mask: a disc of radius creaseWidth around every singular point so far
///   B            [0, 1] bent in one direction in this frame, as a cone is: 0 where |k1| x longer
///                side is below 0.18 rad (flat) or |k2/k1| above 0.7 (crumpled), 1 above 0.3 rad
///                and below 0.5
///   A            [0, 1] coverage: the exact part of the texel that lies in the pattern. R, G and B
///                are not premultiplied by it
///   fold.angle   [rad]  signed turn of the sheet in this frame across one foldWidth, in [-pi, pi],
///                > 0 where it bulges towards its normal. Within half a foldWidth of a crease of
///                the mesh it is the dihedral angle; where paper is rolled it is the principal
///                curvature of larger magnitude x foldWidth, of tensors that are interpolated
///                between vertices. A crease fades in from 0.4 to 0.8 rad (fold_width.h)
///   fold.plastic [rad]  the same for the plastic curvature, which would remain if the paper were
///                released; 0 without plasticity
///   fold.peak    [rad]  the fold.angle of largest magnitude so far, with its sign; never smaller
///                than |fold.angle|
///   age.crease   [s]    time since the first crease through the texel appeared; -1 where there is
///                none. Reaches 1.5 texels beyond the lines of R, so that a filtered lookup where R
///                is drawn never meets the -1
///   age.apex     [s]    time since the birth of the nearest singular point; -1 where there is none
///   apex.dist    [m]    distance to the nearest singular point so far; the sheet's diagonal where
///                there is none
///   apex.id      [1]    number of that point among those of its sheet, in order of birth, from 1:
///                for a shot with one sheet its id in singular.csv; 0 where there is none. Never
///                filtered
///   apex.cone    [rad]  turn of the sheet around that point in this frame: sum of |dihedral angle|
///                over the mesh edges that meet there; 0 where the sheet is flat there, or where
///                there is no point
///   dir.x, dir.y [1]    unit direction of the ruling on the pattern (x right, v up), x >= 0;
///                (0, 0) where the sheet is flat, as for B. A ruling has no orientation: filter
///                (x^2 - y^2, 2 x y), as the levels of tiled_mip are filtered
///   strain.min, strain.max  [%]  smallest and largest principal stretch - 1 in this frame,
///                averaged over the triangles around each vertex and interpolated; < 0 where
///                shortened
///
/// Texels outside the pattern but at most 4 texels from it are padding for texture lookups at the
/// border: A is 0, the shape is that of the nearest point of the border. Beyond them every layer is
/// 0 or has the value for "none" above. Angles are rounded to multiples of 2^-9 rad, which is the
/// step of HALF from 2 rad on, strains to 2^-7 %, directions, R, G and B to 2^-8, distances to at
/// most 1/2 texel or the step of HALF, 2^-11 of the distance. Finer steps show in no picture, and
/// make files twice as large. Layers of shape are computed in 32 bits.
class CreaseMap {
 public:
  CreaseMap(const Pattern&, const CreaseMapOptions&);
  /// The map as it is now, whatever the other one records later: to be written meanwhile.
  CreaseMap(const CreaseMap&);
  ~CreaseMap();

  /// Adds a frame to the history of creases and of fold.peak. Must be called for every frame in
  /// order; the sheet may be remeshed between frames.
  /// curvature  |V|x3 [1/m], of core/geometry/curvature
  /// plastic    |V|x3 [1/m], its plastic part; empty in a simulation without plasticity
  /// throws     Error(ErrorCode::simulation) when one of them is not finite
  void record(int frame, const Sheet&, const Points3& curvature, const Points3& plastic = {});

  /// The map of the last recorded frame, with the history of all recorded frames, as the bytes of
  /// an EXR file. Ages are counted up to info.frame.
  std::string file_bytes(const MapInfo&) const;
  /// Writes it as an AtomicFile. throws Error(ErrorCode::folder)
  void write(const std::filesystem::path&, const MapInfo&) const;

  /// A picture of the same map for people, at most 1024 px wide: the pattern with its creases so
  /// far, red where they bulge towards the normal and blue where away from it, and its singular
  /// points.
  Image picture(const MapInfo&) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace paperbake
