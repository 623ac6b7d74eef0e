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
  double turn;  // [rad] sum of |fold angle| over the edges that meet there, at this frame
};

/// The singular points of a sheet with how far it turns about each: about the vertex next to it.
std::vector<MapApex> map_apices(const Sheet&);

/// All that a map of one frame is drawn from.
struct MapScene {
  int size;                                  // texels on a side
  double side, diagonal;                     // [m] of the pattern
  double crease_width;                       // [m]
  std::vector<std::vector<Vector2d>> loops;  // [texel] corners of the pattern
  MapFields fields;
  std::vector<DetectedCrease> creases;
  std::vector<MapApex> apices;
  const FoldPeak* peak = nullptr;
  int frame;
  double fps;
};

/// Draws some rows of the map; what it does to one row does not depend on the others, but for the
/// order of `rows.first`, which is a multiple of 16. See crease_map.h for the layers.
void draw_map(const MapScene&, const MapRows&, MapTexel*);

}  // namespace paperbake
