#pragma once

#include <Eigen/Geometry>

#include <functional>
#include <vector>

namespace paperbake {

/// A bounding-box tree: the items are halved at the median along the longest side of their box.
class BoxTree {
 public:
  /// boxes  [m] of the items 0, 1, ...
  void build(std::vector<Eigen::AlignedBox3d> boxes);
  /// Calls the visitor with the number of every item whose box meets this one.
  void visit(const Eigen::AlignedBox3d&, const std::function<void(int)>&) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int left = -1, right = -1, item = -1;
  };
  int build(std::vector<int>& items, int begin, int end,
            const std::vector<Eigen::AlignedBox3d>& boxes);
  std::vector<Node> nodes_;
};

}  // namespace paperbake
