#pragma once

#include "formats/maps/crease_history.h"
#include "formats/maps/fold_peak.h"
#include "formats/maps/map_fields.h"
#include "formats/maps/map_file.h"

namespace paperbake {

/// A singular point on a map.
struct MapApex {
  Vector2d pattern;  // [m]
  int frame_of_birth;
  double turn;  // [rad] sum of |dihedral angle| over the edges that meet there in this frame
};

/// The singular points of a sheet, and the turn of the sheet around the vertex nearest to each.
std::vector<MapApex> map_apices(const Sheet&);

/// Everything that a map of one frame is drawn from.
struct MapScene {
  int size;                                  // texels on a side
  double side, diagonal;                     // [m] of the pattern
  double crease_width, fold_width;           // [m]
  std::vector<std::vector<Vector2d>> loops;  // [texel] corners of the pattern
  MapFields fields;
  std::vector<DetectedCrease> creases;
  std::vector<MapApex> apices;
  const FoldPeak* peak = nullptr;
  int frame;
  double fps;
};

/// Draws some rows of the map, whose layers crease_map.h describes. rows.first must be a multiple
/// of 16; then the texels of a row do not depend on which rows are drawn together.
void draw_map(const MapScene&, const MapRows&, MapTexel*);

}  // namespace paperbake
