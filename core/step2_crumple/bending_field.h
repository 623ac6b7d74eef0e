#pragma once

#include "core/geometry/curvature.h"
#include "core/geometry/point_location.h"
#include "core/model/pattern.h"

#include <vector>

namespace paperbake {

/// The bending of a sheet at any point of its pattern: the curvature tensors of the vertices,
/// interpolated.
class BendingField {
 public:
  /// curvature  |V|x3 [1/m] Sxx, Sxy, Syy of the vertices, such as from developable_curvature
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

/// The points of a pattern at which the bending of the sheet is sampled: a square grid that belongs
/// to the pattern, not to a mesh.
class SampleGrid {
 public:
  /// 24 points along the shorter side, but no more than about 1500 altogether
  explicit SampleGrid(const Pattern&);
  int count() const { return static_cast<int>(sample_points.size()); }
  int nearest(const Vector2d& p) const;  // number of the sample point whose cell contains p, or -1

  double step;  // [m] spacing of the grid
  // [m] sample points inside the pattern, row by row
  std::vector<Vector2d> sample_points;
  std::vector<std::vector<int>> neighbours;  // of each sample point, up to four

 private:
  int columns_, rows_;
  std::vector<int> number_;  // of the sample point of each cell; -1: outside the pattern
};

}  // namespace paperbake
