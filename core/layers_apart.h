#pragma once

#include "core/sheet.h"
#include "core/triangle_tree.h"

#include <vector>

namespace paperbake {

/// Takes layers of a fine curved mesh out of each other: where they pass through each other it goes back towards the facets of the
/// simulated mesh, which do not.
///
///   x_v = (1 - s_v) x_v + s_v f_v,   s_v = max_u need_u k(|u - v| / R),   k(r) = (1 - r^2)^2,   R = 8 edges
///
/// f     the same vertices on the facets
/// need  0; of the corners of triangles that pass through each other an eighth more, again and again, until none do
///
/// Vertices that are held stay.
class LayersApart {
 public:
  LayersApart(const Points2& pattern, const Triangles&);

  /// x, facets  |V|x3 [m];  held  |V|.  returns  x was changed. Several threads may ask at the same time.
  bool operator()(Points3& x, const Points3& facets, const std::vector<char>& held) const;

  const TriangleTree& tree() const { return tree_; }

 private:
  void spread(int u, double need, std::vector<double>& share) const;

  Points2 pattern_;
  Triangles triangles_;
  TriangleTree tree_;
  double radius_;                      // [m] R
  std::vector<int> start_, beside_;    // neighbours of each vertex
};

/// A surface that leaves the triangles of a sheet by no more than `off` (|T| [m]) might pass through itself: two of them are near enough,
/// or neighbours folded by more than 120 degrees.
bool may_meet_itself(const Sheet&, const Eigen::VectorXd& off);

}  // namespace paperbake
