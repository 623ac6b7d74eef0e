#include "core/geometry/intersections.h"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

// Intersections are counted with the exact predicates of CGAL, so that the count does not depend on
// the solver's own contact code.

namespace paperbake {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;

// number of boxes below which CGAL tests all pairs; its default of 10 takes three times as long on
// a sheet
constexpr std::ptrdiff_t scanned = 1000;

/// True when the edge p-q passes through the interior of triangle t.
bool pierces(const Point& p, const Point& q, const std::array<Point, 3>& t) {
  const auto above = CGAL::orientation(t[0], t[1], t[2], p),
             below = CGAL::orientation(t[0], t[1], t[2], q);
  if (above == CGAL::COPLANAR || below == CGAL::COPLANAR || above == below) return false;
  const auto s0 = CGAL::orientation(p, q, t[0], t[1]), s1 = CGAL::orientation(p, q, t[1], t[2]),
             s2 = CGAL::orientation(p, q, t[2], t[0]);
  return s0 == s1 && s1 == s2 && s0 != CGAL::COPLANAR;
}

std::array<Point, 3> corners(const Points3& x, const Triangles& triangles, int t) {
  const auto at = [&](int v) { return Point(x(v, 0), x(v, 1), x(v, 2)); };
  return {at(triangles(t, 0)), at(triangles(t, 1)), at(triangles(t, 2))};
}

bool intersect(const std::array<Point, 3>& p, const std::array<Point, 3>& q) {
  for (int i = 0; i < 3; ++i)
    if (pierces(p[(i + 1) % 3], p[(i + 2) % 3], q) || pierces(q[(i + 1) % 3], q[(i + 2) % 3], p))
      return true;
  return false;
}

/// The plane of a triangle, to see at once that most pairs do not intersect.
struct Plane {
  Vector3d normal;
  double offset;
  double rounding;  // [m3] by how much a height over the plane may be wrong

  /// farthest  [m] largest coordinate of all points
  Plane(const Vector3d& a, const Vector3d& b, const Vector3d& c, double farthest)
      : normal((b - a).cross(c - a)), offset(normal.dot(a)) {
    constexpr double eps = 1e-14;  // [1] 90 units of rounding; the sum has less than 30
    rounding = eps * (normal.lpNorm<1>() * farthest +
                      (b - a).lpNorm<1>() * (c - a).lpNorm<1>() * 3 * farthest);
  }
};

/// True when triangles s and t of a mesh intersect.
bool intersect(const Points3& x, const Triangles& triangles, int s, int t) {
  int shared = 0, of_s = -1, of_t = -1;  // number of common corners; the last one in s and in t
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (triangles(s, i) == triangles(t, j)) {
        ++shared;
        of_s = i;
        of_t = j;
      }
  if (shared > 1) return false;
  const auto p = corners(x, triangles, s), q = corners(x, triangles, t);
  if (shared == 0) return intersect(p, q);
  // triangles with a common corner can intersect only by the edges opposite that corner
  return pierces(p[(of_s + 1) % 3], p[(of_s + 2) % 3], q) ||
         pierces(q[(of_t + 1) % 3], q[(of_t + 2) % 3], p);
}

std::vector<Box> boxes_of(const Sheet& sheet) {
  std::vector<Box> boxes;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto p = corners(sheet.x, sheet.triangles, t);
    boxes.emplace_back(p[0].bbox() + p[1].bbox() + p[2].bbox(), t);
  }
  return boxes;
}

constexpr int in_leaf = 8;  // triangles: the boxes of a leaf are compared with one at a time

using Eight = float __attribute__((vector_size(32)));
using EightFlags = std::int32_t __attribute__((vector_size(32)));

/// The boxes of up to eight triangles, a little larger than they are.
struct LeafBoxes {
  Eight low[3], high[3];
};

struct NodeBox {
  float low[3], high[3];
  bool overlaps(const NodeBox& other) const {
    return low[0] <= other.high[0] && other.low[0] <= high[0] && low[1] <= other.high[1] &&
           other.low[1] <= high[1] && low[2] <= other.high[2] && other.low[2] <= high[2];
  }
};

}  // namespace

CrossingCounter::CrossingCounter(const Points2& pattern, const Triangles& triangles)
    : patches_(pattern, triangles) {
  const int count = static_cast<int>(triangles.rows());
  Points2 middles(count, 2);
  for (int t = 0; t < count; ++t)
    middles.row(t) =
        pattern.row(triangles(t, 0)) + pattern.row(triangles(t, 1)) + pattern.row(triangles(t, 2));
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0);
  if (count > 0) build(middles, 0, count);
  triangles_.resize(count, 3);
  for (int k = 0; k < count; ++k) triangles_.row(k) = triangles.row(order_[k]);
}

int CrossingCounter::build(const Points2& middles, int begin, int end) {
  const int at = static_cast<int>(nodes_.size());
  nodes_.push_back({begin, end, -1, {}});
  if (patches_.can_prove()) {
    nodes_[at].cells = patches_.of_triangle(order_[begin]);
    for (int k = begin; k < end; ++k)
      nodes_[at].cells = nodes_[at].cells.joined(patches_.of_triangle(order_[k]));
  }
  if (end - begin <= in_leaf) return at;
  Eigen::RowVector2d low = middles.row(order_[begin]), high = low;
  for (int k = begin; k < end; ++k) {
    low = low.cwiseMin(middles.row(order_[k]));
    high = high.cwiseMax(middles.row(order_[k]));
  }
  const int axis = high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
  const int middle = begin + std::max(in_leaf, (end - begin) / 2 / in_leaf * in_leaf);
  std::nth_element(
      order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int a, int b) {
        return std::make_pair(middles(a, axis), a) < std::make_pair(middles(b, axis), b);
      });
  build(middles, begin, middle);
  const int second = build(middles, middle, end);
  nodes_[at].second = second;
  return at;
}

struct CrossingCounter::Search {
  const CrossingCounter& tree;
  const Points3& x;
  const InjectivePatches::OfShape shape;
  double farthest;  // [m] largest coordinate
  float margin;     // [m] more than rounding to 32 bits moves a coordinate
  // of the leaves that were looked into; leaf k has the triangles from 8 k on
  std::vector<char> is_filled;
  std::vector<LeafBoxes, Eigen::aligned_allocator<LeafBoxes>> leaves;
  std::vector<std::optional<Plane>> planes;
  std::vector<NodeBox> boxes;  // of the nodes
  std::vector<std::pair<int, int>> found;

  Search(const CrossingCounter& of, const Points3& at)
      : tree(of),
        x(at),
        shape(of.patches_, at),
        farthest(x.size() ? x.cwiseAbs().maxCoeff() : 0),
        margin(static_cast<float>(1.2e-7 * farthest)),
        boxes(of.nodes_.size()) {
    if (boxes.empty() || is_apart(tree.nodes_.front().cells)) return;
    const std::size_t triangles = tree.triangles_.rows();
    planes.resize(triangles);
    leaves.resize((triangles + in_leaf - 1) / in_leaf);
    is_filled.assign(leaves.size(), 0);
    for (int n = static_cast<int>(boxes.size()) - 1; n >= 0; --n) set_box(n);
    within(0);
  }

  Vector3d corner(int t, int i) const { return x.row(tree.triangles_(t, i)).transpose(); }

  bool is_apart(const InjectivePatches::Cells& cells) const {
    return tree.patches_.can_prove() && shape.is_injective(cells);
  }
  /// The same for two nodes that are neighbours on the pattern.
  bool are_apart(const Node& a, const Node& b) const {
    if (!tree.patches_.can_prove()) return false;
    const InjectivePatches::Cells both = a.cells.joined(b.cells);
    return both.count() <= 4 * (a.cells.count() + b.cells.count()) && shape.is_injective(both);
  }

  void set_box(int n) {
    const Node& node = tree.nodes_[n];
    NodeBox& box = boxes[n];
    if (node.second >= 0) {
      for (int k = 0; k < 3; ++k) {
        box.low[k] = std::min(boxes[n + 1].low[k], boxes[node.second].low[k]);
        box.high[k] = std::max(boxes[n + 1].high[k], boxes[node.second].high[k]);
      }
      return;
    }
    Eigen::Array3d low = corner(node.begin, 0), high = low;
    for (int t = node.begin; t < node.end; ++t)
      for (int i = 0; i < 3; ++i) {
        const double* p = x.data() + 3 * std::ptrdiff_t(tree.triangles_(t, i));
        low = low.min(Eigen::Map<const Eigen::Array3d>(p));
        high = high.max(Eigen::Map<const Eigen::Array3d>(p));
      }
    for (int k = 0; k < 3; ++k) {
      box.low[k] = float(low[k]) - margin;
      box.high[k] = float(high[k]) + margin;
    }
  }

  const LeafBoxes& boxes_of_leaf(int leaf) {
    LeafBoxes& of_leaf = leaves[leaf];
    if (is_filled[leaf]) return of_leaf;
    is_filled[leaf] = 1;
    const float nowhere = std::numeric_limits<float>::infinity();
    for (int lane = 0; lane < in_leaf; ++lane) {
      const int t = leaf * in_leaf + lane;
      const bool there = t < tree.triangles_.rows();
      for (int k = 0; k < 3; ++k) {
        const float a = there ? float(corner(t, 0)[k]) : nowhere,
                    b = there ? float(corner(t, 1)[k]) : nowhere,
                    c = there ? float(corner(t, 2)[k]) : nowhere;
        of_leaf.low[k][lane] = std::min({a, b, c}) - margin;
        of_leaf.high[k][lane] = there ? std::max({a, b, c}) + margin : -nowhere;
      }
    }
    return of_leaf;
  }

  const Plane& plane_of(int t) {
    if (!planes[t]) planes[t].emplace(corner(t, 0), corner(t, 1), corner(t, 2), farthest);
    return *planes[t];
  }

  void within(int n) {
    const Node& node = tree.nodes_[n];
    if (is_apart(node.cells)) return;
    if (node.second < 0) {
      for (int t = node.begin; t < node.end; ++t) meet(t, node.begin / in_leaf, t + 1);
      return;
    }
    within(n + 1);
    within(node.second);
    between(n + 1, node.second);
  }
  void between(int n, int m) {
    const Node &a = tree.nodes_[n], &b = tree.nodes_[m];
    if (!boxes[n].overlaps(boxes[m]) || are_apart(a, b)) return;
    if (a.second < 0 && b.second < 0) {
      const EightFlags apart = lanes_apart(boxes_of_leaf(a.begin / in_leaf), boxes[m]);
      for (int t = a.begin; t < a.end; ++t)
        if (!apart[t % in_leaf]) meet(t, b.begin / in_leaf, b.begin);
    } else if (b.second < 0 || (a.second >= 0 && a.end - a.begin >= b.end - b.begin)) {
      between(n + 1, m);
      between(a.second, m);
    } else {
      between(n, m + 1);
      between(n, b.second);
    }
  }

  /// Which triangles of a leaf have no part in a box: most of those of two leaves side by side.
  static EightFlags lanes_apart(const LeafBoxes& leaf, const NodeBox& box) {
    EightFlags apart = {};
    for (int k = 0; k < 3; ++k) apart |= (leaf.low[k] > box.high[k]) | (leaf.high[k] < box.low[k]);
    return apart;
  }

  /// Triangle s with those of a leaf from `first` on.
  void meet(int s, int leaf, int first) {
    const LeafBoxes &own = boxes_of_leaf(s / in_leaf), &other = boxes_of_leaf(leaf);
    const int lane = s % in_leaf;
    EightFlags apart = {};
    for (int k = 0; k < 3; ++k)
      apart |= (other.low[k] > own.high[k][lane]) | (other.high[k] < own.low[k][lane]);
    std::uint64_t two_lanes[in_leaf / 2];
    std::memcpy(two_lanes, &apart, sizeof apart);
    for (int pair = 0; pair < in_leaf / 2; ++pair) {
      if (~two_lanes[pair] == 0) continue;
      for (const int i : {2 * pair, 2 * pair + 1})
        if (const int t = leaf * in_leaf + i; t >= first && !apart[i] && !beside(s, t) &&
                                              !beside(t, s) && intersect(x, tree.triangles_, s, t))
          found.emplace_back(tree.order_[s], tree.order_[t]);
    }
  }

  /// True when all corners of triangle s but those of triangle t lie strictly on one side of the
  /// plane of t, by more than rounding could account for: then they have no other point in common.
  bool beside(int s, int t) {
    const int *of_s = tree.triangles_.data() + 3 * s, *of_t = tree.triangles_.data() + 3 * t;
    const Plane& plane = plane_of(t);
    int above = 0, below = 0;
    for (int i = 0; i < 3; ++i) {
      const int v = of_s[i];
      if (v == of_t[0] || v == of_t[1] || v == of_t[2]) continue;
      const double* p = x.data() + 3 * std::ptrdiff_t(v);
      const double height = plane.normal.x() * p[0] + plane.normal.y() * p[1] +
                            plane.normal.z() * p[2] - plane.offset;
      if (!(std::abs(height) > plane.rounding)) return false;
      ++(height > 0 ? above : below);
    }
    return above == 0 || below == 0;
  }
};

int CrossingCounter::operator()(const Points3& x) const {
  return static_cast<int>(Search(*this, x).found.size());
}

std::vector<std::pair<int, int>> CrossingCounter::pairs(const Points3& x) const {
  return Search(*this, x).found;
}

int crossings(const Sheet& sheet) {
  // any places do to halve the mesh by; triangles without a sheet have no pattern
  const bool has_pattern = sheet.pattern.rows() == sheet.x.rows();
  const Points2 places = has_pattern ? sheet.pattern : Points2(sheet.x.leftCols<2>());
  return CrossingCounter(places, sheet.triangles)(sheet.x);
}

int crossings_between(const Sheet& one, const Sheet& other) {
  std::vector<Box> ones = boxes_of(one), others = boxes_of(other);
  int count = 0;
  CGAL::box_intersection_d(
      ones.begin(), ones.end(), others.begin(), others.end(),
      [&](const Box& a, const Box& b) {
        count += intersect(corners(one.x, one.triangles, a.info()),
                           corners(other.x, other.triangles, b.info()));
      },
      scanned);
  return count;
}

}  // namespace paperbake
