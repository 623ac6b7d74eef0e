#pragma once

#include "core/model/sheet.h"

#include <Eigen/Geometry>

#include <utility>
#include <vector>

namespace paperbake {

/// Boxes and cones of normals over a mesh that is a sheet of paper, halved on the pattern again and
/// again. Finds what may come near itself: neighbours on the pattern with all normals in one half
/// of space do not [Volino 1994]; on noise 3 % of the pairs are missed.
class NormalConeTree {
 public:
  NormalConeTree(const Points2& pattern, const Triangles&);

  /// Pairs of triangles that may pass through each other while every vertex is somewhere between x
  /// and y on a straight line, in an order that depends on the mesh alone. Pairs with two common
  /// corners are left out.  x, y  |V|x3 [m]
  std::vector<std::pair<int, int>> near(const Points3& x, const Points3& y) const;

 private:
  struct Node {
    int begin, end;  // of order_
    int second;      // child beside the first, which is the next node; -1: a leaf
    Eigen::AlignedBox2d pattern;
  };
  struct Bound {
    Eigen::AlignedBox3d box;
    Vector3d axis;
    double angle;  // [rad] of every normal to the axis, at most; pi: any
  };
  struct Search;
  int build(const Points2& middles, const Points2& pattern, int begin, int end);

  Triangles triangles_;
  std::vector<int> order_;
  std::vector<Node> nodes_;  // parents before their children
};

}  // namespace paperbake
