#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Sample points of a pattern on a regular grid, for the comparison of sheets with different
/// meshes.
class PatternSamples {
 public:
  /// along  number of points on each side of the bounding box; those inside the pattern are used
  explicit PatternSamples(const Pattern&, int along = 41);

  /// Positions of the sample points on a sheet. |samples|x3 [m]
  Points3 operator()(const Sheet&) const;
  /// Unit normals of a sheet there, interpolated from the vertex normals as in shading. |samples|x3
  Points3 normals(const Sheet&) const;

 private:
  Points3 interpolated(const Sheet&, const Points3& per_vertex) const;

  std::vector<Vector2d> points_;  // [m]
};

}  // namespace paperbake
