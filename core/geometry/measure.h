#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// How well a sheet keeps the lengths of its pattern.
struct LengthDistortion {
  double mean = 0;       // c_m = mean over edges of |l - L|/L [1], [Schreck 2015] table 2
  double largest = 0;    // [1]
  Vector2d where{0, 0};  // [m] middle of the worst edge, on the pattern
};
LengthDistortion length_distortion(const Sheet&);

/// How much the most stretched edge is longer than on the pattern: (l - L)/L, at least 0. [1]
double largest_stretch(const Sheet&);

/// Mean length of the edges on the pattern, each counted once for every triangle it belongs to. [m]
double mean_edge(const Points2& pattern, const Triangles&);

/// Largest |2 pi - sum of angles| over the vertices inside the sheet that are no singular points: 0
/// for a developable. [rad]
double angle_defect_max(const Sheet&);

/// Unit normals of the vertices, weighted by the angles of their triangles. |V|x3
Points3 vertex_normals(const Points3& x, const Triangles&);

}  // namespace paperbake
