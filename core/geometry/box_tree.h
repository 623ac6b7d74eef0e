#pragma once

#include <Eigen/Geometry>

#include <functional>
#include <vector>

namespace paperbake {

/// A bounding-box tree: the items are halved at the median along the longest side of their box.
class BoxTree {
 public:
  bool empty() const { return nodes_.empty(); }
  /// boxes  [m] of the items 0, 1, ...
  void build(std::vector<Eigen::AlignedBox3d> boxes);
  /// Moves the items, as many as before, without another division into halves.
  void refit(const std::vector<Eigen::AlignedBox3d>& boxes);
  /// Calls the visitor with the number of every item whose box meets this one.
  void visit(const Eigen::AlignedBox3d&, const std::function<void(int)>&) const;
  /// Whether the box of some item reaches above a plane: has a point with normal . point > level.
  bool reaches_above(const Eigen::Vector3d& normal, double level) const;
  /// Finds the item nearest to p: calls `distance` with the number of an item wherever its box is
  /// not farther from p than `within` and than what it has returned so far. The order of the calls
  /// is that of the tree: of items at equal distances, which is the nearest is up to the caller.
  /// within    [m]
  /// distance  [m] of an item from p
  void visit_nearest(const Eigen::Vector3d& p, double within,
                     const std::function<double(int)>& distance) const;

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
