#include "core/geometry/normal_cone_tree.h"

#include "core/geometry/connected_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace paperbake {
namespace {

constexpr int max_in_leaf = 4;
constexpr double any = M_PI;
constexpr double half_space = 1.5;  // [rad] a cone with a smaller angle lies in one half-space

/// [rad] acos(c), or up to 1.4e-4 more. source  [Abramowitz 1964], 4.4.45
double angle_with_cosine(double c) {
  const double m = std::min(std::abs(c), 1.0);
  const double angle =
      std::sqrt(1 - m) * (1.5707288 + m * (-0.2121144 + m * (0.0742610 - m * 0.0187293)));
  return 7e-5 + (c < 0 ? M_PI - angle : angle);
}

using Four = double __attribute__((vector_size(32)));
using FourFlags = std::int64_t __attribute__((vector_size(32)));

/// Three numbers, and one that is always zero: one register.
struct FourPoint {
  Four at;
};
template <class T>
using Aligned = std::vector<T, Eigen::aligned_allocator<T>>;  // as in injective_patches.h

Aligned<FourPoint> in_fours(const Points3& x) {
  Aligned<FourPoint> points;
  points.reserve(x.rows());
  for (Eigen::Index v = 0; v < x.rows(); ++v)
    points.push_back(FourPoint{{x(v, 0), x(v, 1), x(v, 2), 0}});
  return points;
}

struct FourBox {
  static constexpr double far = std::numeric_limits<double>::infinity();
  Four low{far, far, far, far}, high{-far, -far, -far, -far};

  void extend(const Four& p) {
    low = p < low ? p : low;
    high = p > high ? p : high;
  }
};
FourBox merged(FourBox a, const FourBox& b) {
  a.extend(b.low);
  a.extend(b.high);
  return a;
}
bool intersect(const FourBox& a, const FourBox& b) {
  const FourFlags meet = (a.low <= b.high) & (b.low <= a.high);
  return (meet[0] & meet[1] & meet[2] & meet[3]) != 0;
}

struct Bound {
  FourBox box;
  Vector3d axis;
  double angle;  // [rad] largest angle between a normal and the axis; pi: any direction
};

/// |T| For each triangle the number of its sheet, in the order of the sheets' first triangles.
/// Triangles of one sheet are joined by common vertices.
std::vector<int> sheet_of_triangles(const Triangles& triangles, Eigen::Index vertices) {
  const std::vector<int> part = connected_parts(triangles, vertices);
  std::vector<int> number(vertices, -1), sheets;
  int count = 0;
  for (int t = 0; t < triangles.rows(); ++t) {
    int& of_sheet = number[part[triangles(t, 0)]];
    if (of_sheet < 0) of_sheet = count++;
    sheets.push_back(of_sheet);
  }
  return sheets;
}

}  // namespace

/// What the halving of a mesh goes by.
struct NormalConeTree::Halving {
  const Points2& pattern;   // [m]
  Points2 middles;          // |T|x2 [m] of the triangles
  std::vector<int> sheets;  // |T| number of the sheet, from 0 on
};

NormalConeTree::NormalConeTree(const Points2& pattern, const Triangles& triangles)
    : order_(triangles.rows()), triangles_(triangles) {
  if (triangles.rows() == 0) return;
  std::iota(order_.begin(), order_.end(), 0);
  Halving by{pattern, Points2(triangles.rows(), 2), sheet_of_triangles(triangles, pattern.rows())};
  for (int t = 0; t < triangles.rows(); ++t)
    by.middles.row(t) = (pattern.row(triangles(t, 0)) + pattern.row(triangles(t, 1)) +
                         pattern.row(triangles(t, 2))) /
                        3;
  build(by, 0, static_cast<int>(triangles.rows()));
  for (std::size_t k = 0; k < order_.size(); ++k) triangles_.row(k) = triangles.row(order_[k]);
}

int NormalConeTree::build(const Halving& by, int begin, int end) {
  const int at = static_cast<int>(nodes_.size());
  Eigen::AlignedBox2d box, centres;
  int first_sheet = by.sheets[order_[begin]], last_sheet = first_sheet;
  for (int k = begin; k < end; ++k) {
    const int t = order_[k];
    centres.extend(by.middles.row(t).transpose());
    for (int i = 0; i < 3; ++i) box.extend(by.pattern.row(triangles_(t, i)).transpose());
    first_sheet = std::min(first_sheet, by.sheets[t]);
    last_sheet = std::max(last_sheet, by.sheets[t]);
  }
  const bool of_several = first_sheet < last_sheet;
  nodes_.push_back({begin, end, -1, of_several ? -1 : first_sheet, box});
  if (end - begin <= max_in_leaf && !of_several) return at;
  const auto from = order_.begin() + begin, to = order_.begin() + end;
  int middle = (begin + end) / 2;
  if (of_several) {
    const int below = (first_sheet + last_sheet + 1) / 2;
    middle = static_cast<int>(
        std::stable_partition(from, to, [&](int t) { return by.sheets[t] < below; }) -
        order_.begin());
  } else {
    const int axis = centres.sizes().x() >= centres.sizes().y() ? 0 : 1;
    std::nth_element(from, order_.begin() + middle, to, [&](int a, int b) {
      return std::make_pair(by.middles(a, axis), a) < std::make_pair(by.middles(b, axis), b);
    });
  }
  build(by, begin, middle);
  const int second = build(by, middle, end);
  nodes_[at].second = second;
  return at;
}

struct NormalConeTree::Search {
  const NormalConeTree& tree;
  int ends = 2;                 // positions that a triangle moves between
  Aligned<FourBox> boxes = {};  // of the swept triangles, in the tree's order
  Aligned<Bound> bounds = {};
  std::vector<std::pair<int, int>> found = {};

  Search(const NormalConeTree& of, const Points3& x, const Points3& y)
      : tree(of), boxes(of.order_.size()), bounds(of.nodes_.size()) {
    // when nothing moves, both ends are the same
    ends = &x == &y ? 1 : 2;
    std::vector<Vector3d> normals(ends * boxes.size());
    for (int end = 0; end < ends; ++end) {
      const Aligned<FourPoint> at = in_fours(end ? y : x);
      for (std::size_t k = 0; k < boxes.size(); ++k) {
        const int* v = tree.triangles_.data() + 3 * k;
        const Four &a = at[v[0]].at, &b = at[v[1]].at, &c = at[v[2]].at;
        boxes[k].extend(a);
        boxes[k].extend(b);
        boxes[k].extend(c);
        const Four ab = b - a, ac = c - a;
        normals[ends * k + end] =
            Vector3d(ab[0], ab[1], ab[2]).cross(Vector3d(ac[0], ac[1], ac[2])).normalized();
      }
    }
    for (int n = static_cast<int>(bounds.size()) - 1; n >= 0; --n) {
      const Node& node = tree.nodes_[n];
      bounds[n] =
          node.second < 0 ? leaf(node, normals) : joined(bounds[n + 1], bounds[node.second]);
    }
    if (!bounds.empty()) within(0);
  }

  Bound leaf(const Node& node, const std::vector<Vector3d>& normals) const {
    Bound bound{{}, Vector3d::Zero(), 0};
    for (int k = node.begin; k < node.end; ++k) bound.box = merged(bound.box, boxes[k]);
    for (int k = ends * node.begin; k < ends * node.end; ++k) bound.axis += normals[k];
    bound.axis.normalize();
    double least = 1;
    for (int k = ends * node.begin; k < ends * node.end; ++k)
      least = std::min(least, normals[k].dot(bound.axis));
    bound.angle = angle_with_cosine(least);
    return bound;
  }
  /// True when joined(a, b).angle is below half_space.
  static bool lie_in_half_space(const Bound& a, const Bound& b) {
    const double larger = std::max(a.angle, b.angle);
    if (larger >= half_space) return false;
    return larger + 0.5 * angle_with_cosine(a.axis.dot(b.axis)) < half_space;
  }
  static Bound joined(const Bound& a, const Bound& b) {
    Bound both{merged(a.box, b.box), (a.axis + b.axis).normalized(), any};
    if (std::max(a.angle, b.angle) < half_space)
      both.angle =
          std::min(any, std::max(a.angle, b.angle) + 0.5 * angle_with_cosine(a.axis.dot(b.axis)));
    return both;
  }

  void within(int n) {
    const Node& node = tree.nodes_[n];
    if (node.sheet >= 0 && bounds[n].angle < half_space) return;
    if (node.second >= 0) {
      within(n + 1);
      within(node.second);
      between(n + 1, node.second);
      return;
    }
    for (int i = node.begin; i < node.end; ++i)
      for (int j = i + 1; j < node.end; ++j) meet(i, j);
  }
  void between(int n, int m) {
    if (!intersect(bounds[n].box, bounds[m].box)) return;
    const Node &a = tree.nodes_[n], &b = tree.nodes_[m];
    const bool neighbours = a.sheet >= 0 && a.sheet == b.sheet && a.pattern.intersects(b.pattern);
    if (neighbours && lie_in_half_space(bounds[n], bounds[m])) return;
    if (a.second < 0 && b.second < 0) {
      for (int i = a.begin; i < a.end; ++i)
        for (int j = b.begin; j < b.end; ++j) meet(i, j);
    } else if (b.second < 0 || (a.second >= 0 && a.end - a.begin >= b.end - b.begin)) {
      between(n + 1, m);
      between(a.second, m);
    } else {
      between(n, m + 1);
      between(n, b.second);
    }
  }
  void meet(int i, int j) {
    if (!intersect(boxes[i], boxes[j])) return;
    int shared = 0;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) shared += tree.triangles_(i, k) == tree.triangles_(j, l);
    if (shared < 2) found.emplace_back(tree.order_[i], tree.order_[j]);
  }
};

std::vector<std::pair<int, int>> NormalConeTree::near(const Points3& x, const Points3& y) const {
  return Search(*this, x, y).found;
}

}  // namespace paperbake
