#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Points of a pattern on a regular grid, by which sheets on different meshes are compared.
class PatternSamples {
 public:
  /// along  points on each side of the bounding box; those that lie in the pattern count
  explicit PatternSamples(const Pattern&, int along = 41);

  /// Where the points are on a sheet, and its normals there as they are shaded: of vertices,
  /// interpolated. [m], unit
  struct Sampled {
    Points3 x, normals;
  };
  Sampled operator()(const Sheet&) const;

 private:
  std::vector<Vector2d> points_;  // [m]
};

/// Root of the mean square distance. [m]
double rms_distance(const Points3& a, const Points3& b);

}  // namespace paperbake
