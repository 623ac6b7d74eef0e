#include "core/geometry/box_tree.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace paperbake {

void BoxTree::build(std::vector<Eigen::AlignedBox3d> boxes) {
  nodes_.clear();
  std::vector<int> items(boxes.size());
  std::iota(items.begin(), items.end(), 0);
  if (!items.empty()) build(items, 0, static_cast<int>(items.size()), boxes);
}

int BoxTree::build(std::vector<int>& items, int begin, int end,
                   const std::vector<Eigen::AlignedBox3d>& boxes) {
  const int at = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (int k = begin; k < end; ++k) box.extend(boxes[items[k]]);
  nodes_[at].box = box;
  if (end - begin == 1) {
    nodes_[at].item = items[begin];
    return at;
  }
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                   [&](int a, int b) {
                     const double ca = boxes[a].min()[axis] + boxes[a].max()[axis],
                                  cb = boxes[b].min()[axis] + boxes[b].max()[axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  const int left = build(items, begin, middle, boxes), right = build(items, middle, end, boxes);
  nodes_[at].left = left;
  nodes_[at].right = right;
  return at;
}

void BoxTree::refit(const std::vector<Eigen::AlignedBox3d>& boxes) {
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node)  // children before parents
    node->box = node->item >= 0 ? boxes[node->item]
                                : nodes_[node->left].box.merged(nodes_[node->right].box);
}

bool BoxTree::reaches_above(const Eigen::Vector3d& normal, double level) const {
  if (nodes_.empty()) return false;
  std::array<int, 64> open;
  int top = 0;
  open[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[open[--top]];
    const double highest = (normal.array() > 0).select(node.box.max(), node.box.min()).dot(normal);
    if (!(highest > level)) continue;
    if (node.item >= 0) return true;
    open[top++] = node.right;
    open[top++] = node.left;
  }
  return false;
}

}  // namespace paperbake
