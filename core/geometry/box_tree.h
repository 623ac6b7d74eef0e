#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <utility>
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
  template <class Visit>
  void visit(const Eigen::AlignedBox3d&, Visit visit) const;
  /// Whether the box of some item reaches above a plane: has a point with normal . point > level.
  bool reaches_above(const Eigen::Vector3d& normal, double level) const;
  /// Finds the item nearest to p: calls `distance` with the number of an item wherever its box is
  /// not farther from p than `within` and than what it has returned so far. The order of the calls
  /// is that of the tree: of items at equal distances, which is the nearest is up to the caller.
  /// within    [m]
  /// distance  [m] of an item from p
  template <class Distance>
  void visit_nearest(const Eigen::Vector3d& p, double within, Distance distance) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int left = -1, right = -1, item = -1;
  };
  int build(std::vector<int>& items, int begin, int end,
            const std::vector<Eigen::AlignedBox3d>& boxes);
  std::vector<Node> nodes_;
};

template <class Visit>
void BoxTree::visit(const Eigen::AlignedBox3d& box, Visit visit) const {
  if (nodes_.empty()) return;
  std::array<int, 64> open;
  int top = 0;
  open[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[open[--top]];
    if (!node.box.intersects(box)) continue;
    if (node.item >= 0)
      visit(node.item);
    else {
      open[top++] = node.right;
      open[top++] = node.left;
    }
  }
}

template <class Distance>
void BoxTree::visit_nearest(const Eigen::Vector3d& p, double within, Distance distance) const {
  if (nodes_.empty()) return;
  const double rounding = 1e-12 * (1 + p.cwiseAbs().maxCoeff());  // [m] of distances from p
  struct Open {
    int node;
    double distance;
  };
  const auto open_node = [&](int k) { return Open{k, nodes_[k].box.exteriorDistance(p)}; };
  std::array<Open, 64> open;
  int top = 0;
  open[top++] = open_node(0);
  while (top > 0) {
    const Open next = open[--top];
    if (next.distance > within + rounding) continue;
    const Node& node = nodes_[next.node];
    if (node.item >= 0) {
      within = std::min(within, distance(node.item));
      continue;
    }
    Open nearer = open_node(node.left), farther = open_node(node.right);
    if (farther.distance < nearer.distance) std::swap(nearer, farther);
    open[top++] = farther;
    open[top++] = nearer;
  }
}

}  // namespace paperbake
