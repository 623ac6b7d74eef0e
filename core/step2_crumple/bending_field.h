#pragma once

#include "core/geometry/curvature.h"
#include "core/geometry/point_location.h"
#include "core/model/pattern.h"

#include <vector>

namespace paperbake {

/// How the sheet bends at any point of its pattern: the curvature tensors of its vertices,
/// interpolated.
class BendingField {
 public:
  /// curvature  |V|x3 [1/m] as from developable_curvature
  BendingField(const Sheet& sheet, const Points3& curvature)
      : locator_(sheet.pattern, sheet.triangles),
        triangles_(sheet.triangles),
        curvature_(curvature) {}
  Principal at(const Vector2d& p) const {
    return principal_curvature(interpolate(locator_.locate(p), triangles_, curvature_));
  }

 private:
  PointLocator locator_;
  Triangles triangles_;
  Points3 curvature_;
};

/// Places all over a pattern where its bending is asked for: a square grid that belongs to the
/// pattern, not to a mesh.
class SampleGrid {
 public:
  /// 24 along the shorter side, no more than 1500 in all
  explicit SampleGrid(const Pattern&);
  int count() const { return static_cast<int>(sample_points.size()); }
  int nearest(const Vector2d& p) const;  // number of the place in whose cell p lies; -1: outside

  double step;                               // [m]
  std::vector<Vector2d> sample_points;       // [m] inside the pattern, row by row
  std::vector<std::vector<int>> neighbours;  // of each place: up to four

 private:
  int columns_, rows_;
  std::vector<int> number_;  // by cell, -1: outside
};

}  // namespace paperbake
