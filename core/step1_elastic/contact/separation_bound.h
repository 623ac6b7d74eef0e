#pragma once

#include "core/step1_elastic/energies/membrane.h"

#include <vector>

namespace paperbake {

/// Tells at little cost that no two points of a sheet are nearer to each other than a share of
/// their distance on the pattern.
///
/// Seen along one direction, a triangle is mapped to the plane by some J. Where x.Jx >= share x.x
/// holds in all triangles of a convex pattern, it sums up along the straight line between any two
/// of its points: their images, and so they themselves, are at least share times as far apart. J is
/// linear in the positions: what holds at both ends of a straight way holds all along it. Only
/// convex patterns have such lines; of others nothing is known.
class SeparationBound {
 public:
  SeparationBound(const Points2& pattern, const Triangles&);

  /// Is it so, as far as the direction that the sheet faces on the whole can tell, all the way?
  /// false: it may be so or not.
  /// from, to  |V|x3 [m]
  bool holds_along_step(const Points3& from, const Points3& to, double share) const;

 private:
  Triangles triangles_;
  std::vector<RestTriangle> rest_;
  bool convex_;
};

}  // namespace paperbake
