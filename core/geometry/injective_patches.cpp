#include "core/geometry/injective_patches.h"

#include "core/geometry/mesh_edges.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace paperbake {
namespace {

using Eight = InjectivePatches::Eight;
using GradientBox = InjectivePatches::GradientBox;

constexpr float unbounded = std::numeric_limits<float>::infinity();
constexpr double cell_edges = 1.5;  // [mean edges] side of a cell
constexpr int max_levels = 4;       // of squares whose boxes are kept: up to 8 cells wide
// [cells] by how much more than its triangles a rectangle reaches, for ways that are not straight
constexpr double margin = 0.1;

/// Where the border goes on from each of its vertices; nothing when an edge has two triangles on
/// the same side, or a vertex two borders.
std::optional<std::map<int, int>> border_from(const Triangles& triangles) {
  const MeshEdges edges(triangles);
  for (const MeshEdge& e : edges)
    if (e.size() > 2 || (e.size() == 2 && e[0].forwards == e[1].forwards)) return {};
  std::map<int, int> next;
  for (const auto& [a, b] : border_of(edges))
    if (!next.emplace(a, b).second) return {};
  return next;
}

/// By how much a border turns to the wrong side, all in all [rad]; infinite when it is not one loop
/// that turns once to the left.
double reflex_turn(const Points2& pattern, const std::map<int, int>& next) {
  constexpr double never = std::numeric_limits<double>::infinity();
  if (next.empty()) return never;
  double turned = 0, reflex = 0;
  std::size_t seen = 0;
  for (int a = next.begin()->first; seen < next.size(); ++seen) {
    const auto of_a = next.find(a), of_b = next.find(of_a->second);
    if (of_b == next.end()) return never;
    const int b = of_a->second, c = of_b->second;
    const Vector2d d = pattern.row(b) - pattern.row(a), e = pattern.row(c) - pattern.row(b);
    const double turn = std::atan2(cross(d, e), d.dot(e));
    turned += turn;
    reflex += std::max(0.0, -turn);
    a = b;
    if (a == next.begin()->first) break;
  }
  if (seen + 1 != next.size() || std::abs(turned - 2 * M_PI) > 0.1) return never;
  return reflex;
}

/// The matrix that makes F from two sides of a triangle. Where rounding would make it inexact it is
/// not finite; nothing when the triangle is turned over.
std::optional<std::array<double, 4>> to_gradient(const Vector2d& u, const Vector2d& v) {
  constexpr double inexact = 1e-8;  // [1] sine of an angle
  const double area = cross(u, v);
  if (!(area > 0)) return {};
  if (area < inexact * u.norm() * v.norm()) return {{NAN, NAN, NAN, NAN}};
  return {{v.y() / area, -v.x() / area, -u.y() / area, u.x() / area}};
}

Eight least(const Eight& a, const Eight& b) { return a < b ? a : b; }
Eight most(const Eight& a, const Eight& b) { return a > b ? a : b; }
void join(GradientBox& box, const GradientBox& other) {
  box.low = least(box.low, other.low);
  box.high = most(box.high, other.high);
}

GradientBox nothing() {
  const Eight zero = {};
  return {zero + unbounded, zero - unbounded};
}

/// Is the matrix in the middle of the box farther from singular than all in the box are from it?
bool proves_injective(const GradientBox& box) {
  // [1] for the rounding of F to 32 bits, and ways that are longer than straight ones
  constexpr double spare = 0.02;
  double middle[6], squared = 0;
  for (int k = 0; k < 6; ++k) {
    middle[k] = 0.5 * (double(box.low[k]) + box.high[k]);
    const double half = 0.5 * (double(box.high[k]) - box.low[k]);
    squared += half * half;
  }
  const double a = middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2],
               b = middle[0] * middle[3] + middle[1] * middle[4] + middle[2] * middle[5],
               c = middle[3] * middle[3] + middle[4] * middle[4] + middle[5] * middle[5];
  const double least = 0.5 * (a + c) - std::sqrt(0.25 * (a - c) * (a - c) + b * b);
  // false as well where something is not a number
  return least > 0 && std::sqrt(least) > 1.01 * std::sqrt(squared) + spare;
}

}  // namespace

InjectivePatches::InjectivePatches(const Points2& pattern, const Triangles& triangles)
    : triangles_(triangles) {
  if (triangles.rows() == 0 || !pattern.allFinite()) return;
  const auto border = border_from(triangles);
  if (!border) return;
  double edges = 0;
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector2d a = pattern.row(triangles(t, 0)),
                   u = pattern.row(triangles(t, 1)).transpose() - a,
                   v = pattern.row(triangles(t, 2)).transpose() - a;
    const auto of_triangle = to_gradient(u, v);
    if (!of_triangle) return;
    to_gradient_.push_back(*of_triangle);
    edges += (u.norm() + v.norm() + (u - v).norm()) / 3;
  }
  const Eigen::RowVector2d low = pattern.colwise().minCoeff(),
                           size = pattern.colwise().maxCoeff() - low;
  const double cell =
      std::max(cell_edges * edges / static_cast<double>(triangles.rows()), size.maxCoeff() / 1024);
  columns_ = 1 + static_cast<int>(size.x() / cell);
  rows_ = 1 + static_cast<int>(size.y() / cell);
  // a way around vertices that turn by r in all is never farther from the straight one than r/4 of
  // its length
  if (!(0.25 * reflex_turn(pattern, *border) * size.norm() < margin * cell)) return;
  const auto index = [&](double p, int axis) {
    return std::clamp(static_cast<int>(std::floor((p - low[axis]) / cell)), 0,
                      (axis == 0 ? columns_ : rows_) - 1);
  };
  for (int t = 0; t < triangles.rows(); ++t) {
    Eigen::AlignedBox2d box;
    for (int i = 0; i < 3; ++i) box.extend(pattern.row(triangles(t, i)).transpose());
    const double more = margin * cell;
    cells_.push_back({index(box.min().x() - more, 0), index(box.min().y() - more, 1),
                      index(box.max().x() + more, 0), index(box.max().y() + more, 1)});
  }
  while (levels_ < max_levels && 1 << levels_ <= std::min(columns_, rows_)) ++levels_;
  can_prove_ = true;
}

InjectivePatches::OfShape::OfShape(const InjectivePatches& patches, const Points3& x)
    : patches_(patches) {
  if (!patches.can_prove_) return;
  const int columns = patches.columns_, rows = patches.rows_;
  const std::size_t cells = std::size_t(columns) * rows;
  boxes_.reset(BoxAllocator().allocate(cells * patches.levels_));
  std::fill_n(boxes_.get(), cells, nothing());
  for (int t = 0; t < patches.triangles_.rows(); ++t) {
    const int* v = patches.triangles_.data() + 3 * std::ptrdiff_t(t);
    const double *a = x.data() + 3 * std::ptrdiff_t(v[0]), *b = x.data() + 3 * std::ptrdiff_t(v[1]),
                 *c = x.data() + 3 * std::ptrdiff_t(v[2]);
    const std::array<double, 4>& m = patches.to_gradient_[t];
    Eight F = {};
    float sum = 0;  // not a number when a component is none, whatever the others are
    for (int k = 0; k < 3; ++k) {
      const double u = b[k] - a[k], w = c[k] - a[k];
      F[k] = static_cast<float>(u * m[0] + w * m[2]);
      F[3 + k] = static_cast<float>(u * m[1] + w * m[3]);
      sum += F[k] + F[3 + k];
    }
    GradientBox box{F, F};
    if (!(std::abs(sum) < unbounded)) {
      const Eight zero = {};
      box = {zero - unbounded, zero + unbounded};
    }
    const Cells& reach = patches.cells_[t];
    for (int row = reach.bottom; row <= reach.top; ++row)
      for (int column = reach.left; column <= reach.right; ++column)
        join(boxes_[std::size_t(row) * columns + column], box);
  }
  for (int level = 1; level < patches.levels_; ++level) {
    const int half = 1 << (level - 1);
    const GradientBox* before = boxes_.get() + cells * (level - 1);
    for (int row = 0; row + 2 * half <= rows; ++row)
      for (int column = 0; column + 2 * half <= columns; ++column) {
        const std::size_t at = std::size_t(row) * columns + column,
                          above = at + std::size_t(half) * columns;
        GradientBox box = before[at];
        join(box, before[at + half]);
        join(box, before[above]);
        join(box, before[above + half]);
        boxes_[cells * level + at] = box;
      }
  }
}

bool InjectivePatches::OfShape::is_injective(const Cells& cells) const {
  const int width = cells.right - cells.left + 1, height = cells.top - cells.bottom + 1;
  int level = 0;
  while (level + 1 < patches_.levels_ && 2 << level <= std::min(width, height)) ++level;
  const int side = 1 << level;
  GradientBox box = nothing();
  for (int row = cells.bottom;; row = std::min(row + side, cells.top + 1 - side)) {
    for (int column = cells.left;; column = std::min(column + side, cells.right + 1 - side)) {
      join(box, boxes_[(std::size_t(level) * patches_.rows_ + row) * patches_.columns_ + column]);
      if (column + side > cells.right) break;
    }
    if (row + side > cells.top) break;
  }
  return proves_injective(box);
}

}  // namespace paperbake
