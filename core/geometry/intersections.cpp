#include "core/geometry/intersections.h"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
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

std::array<Point, 3> corners(const Sheet& sheet, int t) {
  const auto at = [&](int v) { return Point(sheet.x(v, 0), sheet.x(v, 1), sheet.x(v, 2)); };
  return {at(sheet.triangles(t, 0)), at(sheet.triangles(t, 1)), at(sheet.triangles(t, 2))};
}

bool cross(const std::array<Point, 3>& p, const std::array<Point, 3>& q) {
  for (int i = 0; i < 3; ++i)
    if (pierces(p[(i + 1) % 3], p[(i + 2) % 3], q) || pierces(q[(i + 1) % 3], q[(i + 2) % 3], p))
      return true;
  return false;
}

/// The planes of the triangles of a sheet, to see at once that most pairs do not intersect.
class Planes {
 public:
  explicit Planes(const Sheet& sheet) : sheet_(sheet) {
    normals_.reserve(sheet.triangles.rows());
    sizes_.reserve(sheet.triangles.rows());
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      const Vector3d u = (at(t, 1) - at(t, 0)).transpose(), w = (at(t, 2) - at(t, 0)).transpose();
      normals_.push_back(u.cross(w));
      sizes_.push_back(u.lpNorm<1>() * w.lpNorm<1>());
    }
  }

  /// True when all corners of triangle s but those of triangle t lie strictly on one side of the
  /// plane of t, by more than rounding could account for: then they have no other point in common.
  bool beside(int s, int t) const {
    constexpr double rounding = 1e-14;  // [1] 90 units of it; the sum has less than 20
    const Eigen::RowVector3d origin = at(t, 0);
    int above = 0, below = 0;
    for (int i = 0; i < 3; ++i) {
      const int v = sheet_.triangles(s, i);
      if (v == sheet_.triangles(t, 0) || v == sheet_.triangles(t, 1) || v == sheet_.triangles(t, 2))
        continue;
      const Eigen::RowVector3d way = sheet_.x.row(v) - origin;
      const double height = way.dot(normals_[t]), sure = rounding * sizes_[t] * way.lpNorm<1>();
      if (!(std::abs(height) > sure)) return false;
      ++(height > 0 ? above : below);
    }
    return above == 0 || below == 0;
  }

 private:
  Eigen::RowVector3d at(int t, int i) const { return sheet_.x.row(sheet_.triangles(t, i)); }
  const Sheet& sheet_;
  std::vector<Vector3d> normals_;
  std::vector<double> sizes_;  // |u| |w| of the sides that span each triangle
};

/// True when triangles s and t of a mesh intersect.
bool cross(const Sheet& sheet, int s, int t) {
  int shared = 0, of_s = -1, of_t = -1;  // number of common corners; the last one in s and in t
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (sheet.triangles(s, i) == sheet.triangles(t, j)) {
        ++shared;
        of_s = i;
        of_t = j;
      }
  if (shared > 1) return false;
  const auto p = corners(sheet, s), q = corners(sheet, t);
  if (shared == 0) return cross(p, q);
  // triangles with a common corner can intersect only by the edges opposite that corner
  return pierces(p[(of_s + 1) % 3], p[(of_s + 2) % 3], q) ||
         pierces(q[(of_t + 1) % 3], q[(of_t + 2) % 3], p);
}

std::vector<Box> boxes_of(const Sheet& sheet) {
  std::vector<Box> boxes;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto p = corners(sheet, t);
    boxes.emplace_back(p[0].bbox() + p[1].bbox() + p[2].bbox(), t);
  }
  return boxes;
}

/// The boxes of the triangles of a sheet in a grid of cells as large as their mean: on a mesh of
/// even triangles it finds the pairs that overlap in half the time that CGAL takes.
class Grid {
 public:
  explicit Grid(const Sheet& sheet) {
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      const auto a = sheet.x.row(sheet.triangles(t, 0)), b = sheet.x.row(sheet.triangles(t, 1)),
                 c = sheet.x.row(sheet.triangles(t, 2));
      lows_.push_back(a.cwiseMin(b).cwiseMin(c).transpose());
      highs_.push_back(a.cwiseMax(b).cwiseMax(c).transpose());
      cell_ += (highs_.back() - lows_.back()).maxCoeff();
      low = low.cwiseMin(lows_.back());
      high = high.cwiseMax(highs_.back());
    }
    cell_ *= 1.0 / std::max<double>(1, static_cast<double>(lows_.size()));
    low_ = low;
    constexpr double most_cells = 1e6;  // along a side
    fits_ = cell_ > 0 && (high - low).allFinite() && (high - low).maxCoeff() < most_cells * cell_;
    for (std::size_t t = 0; fits_ && t < lows_.size(); ++t) enter(static_cast<int>(t));
  }

  /// False: some triangles are so much larger than others that a grid is of no use.
  bool fits() const { return fits_; }

  /// Calls visit(s, t) for every pair of triangles whose boxes overlap, once.
  template <class Visit>
  void visit_pairs(Visit visit) {
    std::size_t buckets = 1;
    while (buckets < entries_.size()) buckets *= 2;
    std::vector<int> start(buckets + 1, 0), order(entries_.size());
    const auto bucket = [&](const Entry& e) {
      return (e.cell * 0x9e3779b97f4a7c15u >> 32) & (buckets - 1);
    };
    for (const Entry& e : entries_) ++start[bucket(e) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<int> next(start.begin(), start.end() - 1);
    for (std::size_t k = 0; k < entries_.size(); ++k)
      order[next[bucket(entries_[k])]++] = static_cast<int>(k);
    for (std::size_t b = 0; b < buckets; ++b)
      for (int i = start[b]; i < start[b + 1]; ++i)
        for (int j = start[b]; j < i; ++j) {
          const Entry &p = entries_[order[i]], &q = entries_[order[j]];
          if (p.cell == q.cell && overlap_first_in(p.cell, p.triangle, q.triangle))
            visit(p.triangle, q.triangle);
        }
  }

 private:
  struct Entry {
    std::uint64_t cell;  // its three numbers, 21 bits each
    int triangle;
  };

  static std::uint64_t key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return x << 42 | y << 21 | z;
  }
  std::array<std::uint64_t, 3> cell_of(const Vector3d& p) const {
    const Vector3d at = (p - low_) / cell_;
    return {std::uint64_t(at.x()), std::uint64_t(at.y()), std::uint64_t(at.z())};
  }
  void enter(int t) {
    constexpr std::size_t most = 24;  // entries for each triangle, on average
    const auto from = cell_of(lows_[t]), to = cell_of(highs_[t]);
    double count = 1;
    for (int k = 0; k < 3; ++k) count *= static_cast<double>(to[k] - from[k] + 1);
    fits_ = static_cast<double>(entries_.size()) + count < static_cast<double>(most * lows_.size());
    if (!fits_) return;
    for (std::uint64_t x = from[0]; x <= to[0]; ++x)
      for (std::uint64_t y = from[1]; y <= to[1]; ++y)
        for (std::uint64_t z = from[2]; z <= to[2]; ++z) entries_.push_back({key(x, y, z), t});
  }
  /// True where the boxes of both overlap and this is the first cell that has both.
  bool overlap_first_in(std::uint64_t cell, int s, int t) const {
    for (int k = 0; k < 3; ++k)
      if (lows_[s][k] > highs_[t][k] || lows_[t][k] > highs_[s][k]) return false;
    const auto first = cell_of(lows_[s].cwiseMax(lows_[t]));
    return cell == key(first[0], first[1], first[2]);
  }

  std::vector<Vector3d> lows_, highs_;
  std::vector<Entry> entries_;
  double cell_ = 0;
  Vector3d low_;
  bool fits_ = false;
};

}  // namespace

int crossings(const Sheet& sheet) {
  const Planes planes(sheet);
  int count = 0;
  const auto look_at = [&](int s, int t) {
    if (!planes.beside(s, t) && !planes.beside(t, s)) count += cross(sheet, s, t);
  };
  if (Grid grid(sheet); grid.fits()) {
    grid.visit_pairs(look_at);
    return count;
  }
  std::vector<Box> boxes = boxes_of(sheet);
  CGAL::box_self_intersection_d(
      boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { look_at(a.info(), b.info()); },
      scanned);
  return count;
}

int crossings_between(const Sheet& one, const Sheet& other) {
  std::vector<Box> ones = boxes_of(one), others = boxes_of(other);
  int count = 0;
  CGAL::box_intersection_d(
      ones.begin(), ones.end(), others.begin(), others.end(),
      [&](const Box& a, const Box& b) {
        count += cross(corners(one, a.info()), corners(other, b.info()));
      },
      scanned);
  return count;
}

}  // namespace paperbake
