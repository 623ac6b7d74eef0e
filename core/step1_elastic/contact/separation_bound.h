#pragma once

#include "core/geometry/rest_triangle.h"

#include <vector>

namespace paperbake {

/// A cheap lower bound: proves that no two points of a sheet are closer to each other than a given
/// share of their distance on the pattern.
///
/// Seen along one direction, a triangle is mapped to the plane by a matrix J. If x.Jx >= share x.x
/// in all triangles of a convex pattern, the sum along the straight line between any two points of
/// the pattern shows that their images, and so the points themselves, are at least share times as
/// far apart. J is linear in the positions: what holds at both ends of a straight motion holds all
/// along it. Only convex patterns have such lines; nothing is known about others.
class SeparationBound {
 public:
  SeparationBound(const Points2& pattern, const Triangles&);

  /// True if this could be shown for the whole step, looking along the direction that the sheet
  /// faces on the whole. False: it may hold or not.
  /// from, to  |V|x3 [m]
  bool holds_along_step(const Points3& from, const Points3& to, double share) const;

 private:
  Triangles triangles_;
  std::vector<RestTriangle> rest_;
  bool convex_;
};

}  // namespace paperbake
