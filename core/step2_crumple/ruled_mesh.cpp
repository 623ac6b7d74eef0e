#include "core/step2_crumple/ruled_mesh.h"

#include "core/geometry/constrained_delaunay.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_edges.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace paperbake {
namespace {

// Lengths are in mean edge lengths h of the base mesh, where nothing else is said.

constexpr double one_point = 1e-7;     // [h] points this near are one
constexpr double on_side = 10;         // [1] times that: a required point lies on a side
constexpr double straight_on = 1e-6;   // [1] sine of the turning angle of a polygon
constexpr double at_corner = 0.5;      // [1] of the merge distance: of a ruling that cuts a corner
constexpr double onto_border = 0.7;    // [1] of the merge distance: ends move onto the border
constexpr double onto_ruling = 0.9;    // [1] of the merge distance: rulings pass through points
constexpr double onto_point = 0.25;    // [h] a point on a ruling that is this near to another
constexpr double barely_longer = 0.1;  // [1] of a part: a ruling is not divided for that
// [h] how far points of the base mesh keep from those of the rulings and the border, and within
// the discs that no ruling enters, where the mesh stays finer
constexpr double clear = 0.6, clear_in_disc = 0.4;
constexpr double beside_ruling = 0.75;  // [1] of this distance: from the line of a ruling
// [1] of the least altitude of the base mesh: another triangle of the same points may be narrower
constexpr double as_narrow = 0.5;
// [h] a triangle of less altitude is a needle; no mesh has any, unless required points stand so
// near to each other or to the border that the base mesh has some, too
constexpr double needle = 0.03;

double along(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  return (p - a).dot(b - a) / (b - a).squaredNorm();
}

/// The vertices of a polygon in which it turns noticeably.
std::vector<Vector2d> corners_of(const std::vector<Vector2d>& polygon) {
  std::vector<Vector2d> corners;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d in = (polygon[i] - polygon[(i + n - 1) % n]).normalized(),
                   out = (polygon[(i + 1) % n] - polygon[i]).normalized();
    if (std::abs(cross(in, out)) > straight_on || in.dot(out) < 0) corners.push_back(polygon[i]);
  }
  return corners;
}

/// Collects the points and edges of a ruled mesh.
class Builder {
 public:
  Builder(const BaseMesh& base, const std::vector<Vector2d>& required, const RulingOptions& options)
      : base_(base),
        options_(options),
        points_(required),
        tolerance_(options.merge_distance * base.h) {
    add_polygon(base.polygons.outline);
    for (const auto& hole : base.polygons.holes) add_polygon(hole);
  }

  void add_singular(const std::vector<Vector2d>& singular) {
    for (const Vector2d& p : singular) point_at(p, exact());
  }

  void add_rulings(const std::vector<Ruling>& rulings) {
    std::vector<std::pair<int, int>> ends;
    for (const Ruling& r : rulings)
      ends.emplace_back(ruling_end(r.a, near(r)), ruling_end(r.b, near(r)));
    for (std::size_t k = 0; k < ends.size(); ++k)
      add_ruling(ends[k].first, ends[k].second, near(rulings[k]));
    const auto legs = legs_;
    for (const auto& [a, b] : legs) subdivide(a, b);
  }

  void fill(const std::vector<Disc>& keep_out_discs) {
    for (Side& side : sides_) fill_border(side);
    const std::size_t before = points_.size();
    for (const Vector2d& p : base_.inner) {
      const bool guarded =
          std::any_of(keep_out_discs.begin(), keep_out_discs.end(),
                      [&](const Disc& d) { return (p - d.centre).norm() < d.radius; });
      const double apart = (guarded ? clear_in_disc : clear) * base_.h;
      bool free = true;
      for (std::size_t i = 0; i < before && free; ++i) free = (points_[i] - p).norm() >= apart;
      for (const auto& [a, b] : legs_)
        free = free && distance_to_segment(p, points_[a], points_[b]) >= beside_ruling * apart;
      if (free) points_.push_back(p);
    }
  }

  std::optional<RuledMesh> triangulate() const {
    std::vector<std::pair<int, int>> border;
    for (const Side& side : sides_)
      for (std::size_t k = 0; k + 1 < side.stops.size(); ++k)
        border.emplace_back(side.stops[k].second, side.stops[k + 1].second);
    auto triangles = constrained_delaunay(points_, border, pieces_);
    if (!triangles) return std::nullopt;
    RuledMesh mesh;
    mesh.pattern.resize(static_cast<int>(points_.size()), 2);
    for (std::size_t i = 0; i < points_.size(); ++i) mesh.pattern.row(i) = points_[i];
    mesh.triangles = std::move(*triangles);
    return mesh;
  }

 private:
  struct Side {  // a side of a border polygon
    Vector2d a, b;
    std::vector<std::pair<double, int>> stops;  // position along it in [0, 1], point
  };

  double exact() const { return one_point * base_.h; }
  double near(const Ruling& r) const {
    return r.cuts_corner ? at_corner * std::min(tolerance_, options_.merge_distance * r.length())
                         : tolerance_;
  }

  void add_polygon(const std::vector<Vector2d>& polygon) {
    const std::size_t first = sides_.size();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d& a = polygon[i];
      const Vector2d& b = polygon[(i + 1) % polygon.size()];
      sides_.push_back({a, b, {{0.0, point_at(a, exact())}}});
    }
    for (std::size_t s = first; s < sides_.size(); ++s) {
      Side& side = sides_[s];
      side.stops.emplace_back(1.0, s + 1 < sides_.size() ? sides_[s + 1].stops[0].second
                                                         : sides_[first].stops[0].second);
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const double t = along(points_[i], side.a, side.b);
        const bool inside =
            t * (side.b - side.a).norm() > exact() && (1 - t) * (side.b - side.a).norm() > exact();
        if (inside && distance_to_segment(points_[i], side.a, side.b) <= on_side * exact())
          side.stops.emplace_back(t, static_cast<int>(i));
      }
      std::sort(side.stops.begin(), side.stops.end());
    }
  }

  int point_at(const Vector2d& p, double tolerance) {
    int nearest = -1;
    double least = tolerance;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if ((points_[i] - p).norm() <= least) {
        least = (points_[i] - p).norm();
        nearest = static_cast<int>(i);
      }
    if (nearest >= 0) return nearest;
    points_.push_back(p);
    return static_cast<int>(points_.size()) - 1;
  }

  /// The point at which a ruling ends: an existing one when there is one near, otherwise a new one,
  /// which is moved onto the border when that is near.
  int ruling_end(const Vector2d& p, double near) {
    const std::size_t before = points_.size();
    const int point = point_at(p, near);
    if (points_.size() == before) return point;
    for (Side& side : sides_) {
      if (distance_to_segment(p, side.a, side.b) > onto_border * near) continue;
      const double t = along(p, side.a, side.b);
      points_[point] = side.a + t * (side.b - side.a);
      side.stops.emplace_back(t, point);
      std::sort(side.stops.begin(), side.stops.end());
      return point;
    }
    return point;
  }

  /// Adds a ruling from end to end, through the points that lie on its line or close to it.
  void add_ruling(int a, int b, double near) {
    if (a == b) return;
    std::vector<std::pair<double, int>> stops{{0.0, a}, {1.0, b}};
    const double length = (points_[b] - points_[a]).norm();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double t = along(points_[i], points_[a], points_[b]);
      if (int(i) == a || int(i) == b || t * length < exact() || (1 - t) * length < exact())
        continue;
      if (distance_to_segment(points_[i], points_[a], points_[b]) < onto_ruling * near)
        stops.emplace_back(t, static_cast<int>(i));
    }
    std::sort(stops.begin(), stops.end());
    for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
      const std::pair<int, int> leg = std::minmax(stops[k].second, stops[k + 1].second);
      if (on_one_side(leg) || crosses_another(leg) || std::count(legs_.begin(), legs_.end(), leg))
        continue;
      legs_.push_back(leg);
    }
  }

  bool on_one_side(const std::pair<int, int>& leg) const {
    return std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) {
      const auto is_stop = [&](int p) {
        return [p](const std::pair<double, int>& stop) { return stop.second == p; };
      };
      return std::any_of(side.stops.begin(), side.stops.end(), is_stop(leg.first)) &&
             std::any_of(side.stops.begin(), side.stops.end(), is_stop(leg.second));
    });
  }

  bool crosses_another(const std::pair<int, int>& leg) const {
    const Vector2d a = points_[leg.first], b = points_[leg.second];
    return std::any_of(legs_.begin(), legs_.end(), [&](const std::pair<int, int>& other) {
      if (other.first == leg.first || other.first == leg.second || other.second == leg.first ||
          other.second == leg.second)
        return false;
      const Vector2d c = points_[other.first], d = points_[other.second];
      return cross(b - a, c - a) * cross(b - a, d - a) <= 0 &&
             cross(d - c, a - c) * cross(d - c, b - c) <= 0;
    });
  }

  void subdivide(int a, int b) {
    const double length = (points_[b] - points_[a]).norm();
    const int parts = std::max(
        1, static_cast<int>(std::ceil(length / (options_.along_most * base_.h) - barely_longer)));
    int last = a;
    for (int k = 1; k < parts; ++k) {
      const Vector2d p = points_[a] + (points_[b] - points_[a]) * k / parts;
      const std::size_t before = points_.size();
      const int point = point_at(p, onto_point * base_.h);
      if (points_.size() == before) continue;  // a point is near already: the apex of a fan
      pieces_.emplace_back(last, point);
      last = point;
    }
    pieces_.emplace_back(last, b);
  }

  void fill_border(Side& side) {
    std::vector<std::pair<double, int>> filled;
    const double length = (side.b - side.a).norm();
    for (std::size_t k = 0; k + 1 < side.stops.size(); ++k) {
      const double from = side.stops[k].first, to = side.stops[k + 1].first;
      const int parts = std::max(1, static_cast<int>(std::lround((to - from) * length / base_.h)));
      filled.push_back(side.stops[k]);
      for (int i = 1; i < parts; ++i) {
        const double t = from + (to - from) * i / parts;
        filled.emplace_back(t, static_cast<int>(points_.size()));
        points_.push_back(side.a + t * (side.b - side.a));
      }
    }
    filled.push_back(side.stops.back());
    side.stops = std::move(filled);
  }

  const BaseMesh& base_;
  const RulingOptions& options_;
  std::vector<Vector2d> points_;
  double tolerance_;
  std::vector<Side> sides_;
  std::vector<std::pair<int, int>> legs_, pieces_;
};

/// Smallest altitude of a triangle of a mesh. [m]
double min_altitude(const Points2& pattern, const Triangles& triangles) {
  double least = std::numeric_limits<double>::infinity();
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector2d a = pattern.row(triangles(t, 0)), b = pattern.row(triangles(t, 1)),
                   c = pattern.row(triangles(t, 2));
    least = std::min(
        least, cross(b - a, c - a) / std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}));
  }
  return least;
}

}  // namespace

BaseMesh base_mesh(const Points2& pattern, const Triangles& triangles) {
  const std::vector<std::pair<int, int>> border = border_of(MeshEdges(triangles));
  std::map<int, int> next(border.begin(), border.end());
  std::vector<char> outside(pattern.rows(), 0);
  BaseMesh base;
  while (!next.empty()) {
    std::vector<Vector2d> loop;
    double twice_area = 0;
    for (int v = next.begin()->first; next.count(v);) {
      loop.push_back(pattern.row(v));
      outside[v] = 1;
      const int to = next[v];
      next.erase(v);
      twice_area += cross(loop.back(), pattern.row(to).transpose());
      v = to;
    }
    if (twice_area > 0)
      base.polygons.outline = corners_of(loop);
    else
      base.polygons.holes.push_back(corners_of(loop));
  }
  for (int v = 0; v < pattern.rows(); ++v)
    if (!outside[v]) base.inner.push_back(pattern.row(v));
  base.h = mean_edge(pattern, triangles);
  base.least_altitude = min_altitude(pattern, triangles);
  base.triangles = static_cast<int>(triangles.rows());
  return base;
}

std::optional<RuledMesh> ruled_mesh(const BaseMesh& base, const std::vector<Vector2d>& required,
                                    const std::vector<Vector2d>& singular,
                                    const std::vector<Ruling>& rulings,
                                    const std::vector<Disc>& keep_out_discs,
                                    const RulingOptions& options) {
  Builder builder(base, required, options);
  builder.add_singular(singular);
  builder.add_rulings(rulings);
  builder.fill(keep_out_discs);
  auto mesh = builder.triangulate();
  if (!mesh || min_altitude(mesh->pattern, mesh->triangles) <
                   std::min(needle * base.h, as_narrow * base.least_altitude))
    return std::nullopt;
  return mesh;
}

}  // namespace paperbake
