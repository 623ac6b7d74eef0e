#include "core/geometry/pattern_mesh.h"

#include "core/geometry/constrained_delaunay.h"
#include "core/geometry/odt_smoothing.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/error.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace paperbake {
namespace {

/// The points of a mesh under construction: first the border polygons, then the required points
/// inside, then the free points.
struct Cloud {
  std::vector<Vector2d> points;
  std::vector<std::pair<int, int>> border;  // segments of the border polygons
  std::vector<std::pair<int, int>> chords;  // segments of the prescribed creases
  Pattern polygons;                         // region that the border segments enclose
  std::vector<int> point_vertex;
  int fixed = 0;  // number of points, from the first on, that must not move
};

/// What a coarser polygon may do without.
struct Coarseness {
  double longest;                   // [m] no side becomes longer by an omission
  double tolerance;                 // [m] the vertices that are omitted stay within this distance
  std::vector<Vector2d> kept = {};  // [m] vertices that are not omitted
};

/// A closed polygon without the vertices that a coarser one does not need.
std::vector<Vector2d> coarsen(const std::vector<Vector2d>& polygon, const Coarseness& to_be) {
  const auto [longest, tolerance, always] = to_be;
  const auto is_kept = [&always = always](const Vector2d& p) {
    return std::find(always.begin(), always.end(), p) != always.end();
  };
  const std::size_t n = polygon.size();
  std::vector<Vector2d> kept{polygon[0]};
  for (std::size_t from = 0; from < n;) {
    std::size_t to = from + 1;
    while (to < n) {
      const Vector2d& a = polygon[from];
      const Vector2d& b = polygon[(to + 1) % n];
      if ((b - a).norm() > longest) break;
      bool near = (b - a).norm() > 0;
      for (std::size_t k = from + 1; near && k <= to; ++k)
        near = distance_to_segment(polygon[k], a, b) <= tolerance && !is_kept(polygon[k]);
      if (!near) break;
      ++to;
    }
    if (to < n) kept.push_back(polygon[to]);
    from = to;
  }
  return kept.size() < 3 ? polygon : kept;
}

/// A closed polygon with these points, which lie on it to within `snap` [m], among its vertices.
std::vector<Vector2d> with_vertices(std::vector<Vector2d> polygon,
                                    const std::vector<Vector2d>& points, double snap) {
  for (const Vector2d& p : points)
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      if (distance_to_segment(p, a, b) > snap) continue;
      if ((p - a).norm() <= snap)
        polygon[k] = p;
      else if ((p - b).norm() <= snap)
        polygon[(k + 1) % polygon.size()] = p;
      else
        polygon.insert(polygon.begin() + static_cast<long>(k) + 1, p);
      break;
    }
  return polygon;
}

/// The border polygons as coarsely as edges of this length follow them. The ends of creases on a
/// curved border stay on it: between one of them and a chord beside it there would be a needle.
Pattern coarse_border(const Pattern& pattern, double edge, double border, double snap) {
  const auto coarsened = [&](const std::vector<Vector2d>& ends) {
    const Coarseness to_be{1.2 * edge, border * edge, ends};
    Pattern polygons;
    polygons.outline = coarsen(with_vertices(pattern.outline, ends, snap), to_be);
    for (const auto& hole : pattern.holes)
      polygons.holes.push_back(coarsen(with_vertices(hole, ends, snap), to_be));
    return polygons;
  };
  Pattern polygons = coarsened({});
  std::vector<Vector2d> ends;
  bool cut_off = false;
  for (const Vector2d& p : crease_points(pattern.prescribed_creases)) {
    if ((nearest_border_point(pattern, p) - p).norm() > snap) continue;
    cut_off = cut_off || (nearest_border_point(polygons, p) - p).norm() > snap;
    ends.push_back(p);
  }
  return cut_off ? coarsened(ends) : polygons;
}

/// The corner of the border polygons that is within `near` of p [m]; none: no corner is.
std::optional<Vector2d> corner_beside(const Pattern& polygons, const Vector2d& p, double near) {
  std::optional<Vector2d> found;
  const auto look_at = [&](const std::vector<Vector2d>& polygon) {
    for (const Vector2d& corner : polygon)
      if ((corner - p).norm() <= near) found = corner, near = (corner - p).norm();
  };
  look_at(polygons.outline);
  for (const auto& hole : polygons.holes) look_at(hole);
  return found;
}

/// Divides one border polygon into parts of about `edge` [m]; required points that lie on it become
/// vertices.
void sample_border(const std::vector<Vector2d>& polygon, double edge,
                   const std::vector<Vector2d>& required, double snap, Cloud& cloud) {
  const int first = static_cast<int>(cloud.points.size());
  for (std::size_t s = 0; s < polygon.size(); ++s) {
    const Vector2d a = polygon[s], b = polygon[(s + 1) % polygon.size()], d = b - a;
    const double length = d.norm();
    std::vector<double> stops{0.0, length};
    for (std::size_t k = 0; k < required.size(); ++k) {
      const double at = (required[k] - a).dot(d) / length;
      if (at > snap && at < length - snap && distance_to_segment(required[k], a, b) <= snap)
        stops.push_back(at);
    }
    std::sort(stops.begin(), stops.end());
    stops.erase(
        std::unique(stops.begin(), stops.end(), [&](double p, double q) { return q - p <= snap; }),
        stops.end());
    for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
      const int parts =
          std::max(1, static_cast<int>(std::lround((stops[k + 1] - stops[k]) / edge)));
      for (int i = 0; i < parts; ++i)
        cloud.points.push_back(a +
                               d * ((stops[k] + (stops[k + 1] - stops[k]) * i / parts) / length));
    }
  }
  const int last = static_cast<int>(cloud.points.size());
  for (int i = first; i < last; ++i) cloud.border.emplace_back(i, i + 1 < last ? i + 1 : first);
}

void add_required(const std::vector<Vector2d>& required, double snap, Cloud& cloud) {
  for (const Vector2d& p : required) {
    int nearest = -1;
    double least = snap;
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      if ((cloud.points[i] - p).norm() <= least) {
        least = (cloud.points[i] - p).norm();
        nearest = static_cast<int>(i);
      }
    if (nearest < 0) {
      nearest = static_cast<int>(cloud.points.size());
      cloud.points.push_back(p);
    }
    cloud.point_vertex.push_back(nearest);
  }
  cloud.fixed = static_cast<int>(cloud.points.size());
}

/// Divides prescribed creases into parts of about `edge` [m], through the points that lie on them.
void add_folds(const std::vector<PrescribedCrease>& folds, double edge, double snap, Cloud& cloud) {
  const auto vertex_at = [&](const Vector2d& p) {
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      if (std::abs(cloud.points[i].x() - p.x()) <= snap && (cloud.points[i] - p).norm() <= snap)
        return static_cast<int>(i);
    cloud.points.push_back(p);
    return static_cast<int>(cloud.points.size()) - 1;
  };
  for (const Vector2d& p : crease_points(folds)) vertex_at(p);
  for (const PrescribedCrease& fold : folds)
    for (std::size_t s = 0; s + 1 < fold.line.size(); ++s) {
      const Vector2d a = fold.line[s], d = fold.line[s + 1] - a;
      std::vector<std::pair<double, int>> stops;  // fraction of the segment, vertex
      Eigen::AlignedBox2d near(a.cwiseMin(a + d), a.cwiseMax(a + d));
      near.min().array() -= 2 * snap;
      near.max().array() += 2 * snap;
      for (std::size_t i = 0; i < cloud.points.size(); ++i)
        if (near.contains(cloud.points[i]) &&
            distance_to_segment(cloud.points[i], a, a + d) <= snap)
          stops.emplace_back((cloud.points[i] - a).dot(d) / d.squaredNorm(), static_cast<int>(i));
      std::sort(stops.begin(), stops.end());
      int last = stops.front().second;
      for (std::size_t k = 1; k < stops.size(); ++k) {
        const double from = stops[k - 1].first, to = stops[k].first;
        const int parts = std::max(1, static_cast<int>(std::lround((to - from) * d.norm() / edge)));
        for (int i = 1; i <= parts; ++i) {
          const int next =
              i == parts ? stops[k].second : vertex_at(a + (from + (to - from) * i / parts) * d);
          cloud.chords.emplace_back(last, next);
          last = next;
        }
      }
    }
  std::set<int> vertices;
  for (const auto& [a, b] : cloud.chords) vertices.insert({a, b});
  cloud.point_vertex.insert(cloud.point_vertex.end(), vertices.begin(), vertices.end());
  const auto on_border = [&](const std::pair<int, int>& chord) {
    return std::any_of(cloud.border.begin(), cloud.border.end(), [&](const auto& side) {
      return std::minmax(side.first, side.second) == std::minmax(chord.first, chord.second);
    });
  };
  cloud.chords.erase(std::remove_if(cloud.chords.begin(), cloud.chords.end(), on_border),
                     cloud.chords.end());
  cloud.fixed = static_cast<int>(cloud.points.size());
}

/// Unit vector along the longest side of the outline.
Vector2d grain(const std::vector<Vector2d>& outline) {
  Vector2d best(0, 0);
  for (std::size_t s = 0; s < outline.size(); ++s) {
    const Vector2d d = outline[(s + 1) % outline.size()] - outline[s];
    if (d.norm() > best.norm() * (1 + 1e-9)) best = d;
  }
  return best.normalized();
}

/// Fills the interior with rows of equilateral triangles that are fitted to the extent of the
/// outline along its longest side.
void add_lattice(double edge, double turn, Cloud& cloud) {
  const Vector2d along = Eigen::Rotation2Dd(turn) * grain(cloud.polygons.outline),
                 across(-along.y(), along.x());
  Eigen::AlignedBox2d box;
  for (const Vector2d& p : cloud.polygons.outline)
    box.extend(Vector2d(p.dot(along), p.dot(across)));
  const Vector2d size = box.sizes();
  const int columns = std::max(1, static_cast<int>(std::lround(size.x() / edge)));
  const int rows = std::max(1, static_cast<int>(std::lround(size.y() / (edge * std::sqrt(0.75)))));
  const Vector2d step(size.x() / columns, size.y() / rows);

  const double clear = 0.6 * edge, clear_border = 0.4 * edge;
  // the fixed points in a grid of cells of that clearance, so that nine cells need to be searched
  std::multimap<std::pair<int, int>, int> cells;
  const auto cell = [&](const Vector2d& p) {
    return std::make_pair(int(std::floor(p.x() / clear)), int(std::floor(p.y() / clear)));
  };
  for (int i = 0; i < cloud.fixed; ++i) cells.emplace(cell(cloud.points[i]), i);
  const auto crowded = [&](const Vector2d& p) {
    const auto [cx, cy] = cell(p);
    for (int x = cx - 1; x <= cx + 1; ++x)
      for (int y = cy - 1; y <= cy + 1; ++y) {
        const auto range = cells.equal_range({x, y});
        for (auto it = range.first; it != range.second; ++it)
          if ((cloud.points[it->second] - p).norm() < clear) return true;
      }
    return false;
  };
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c) {
      const double offset = r % 2 ? 0.5 : 0.0;
      const Vector2d local = box.min() + Vector2d((c + offset) * step.x(), r * step.y());
      const Vector2d p = local.x() * along + local.y() * across;
      if (!contains(cloud.polygons, p) || crowded(p)) continue;
      if ((nearest_border_point(cloud.polygons, p) - p).norm() < clear_border) continue;
      cloud.points.push_back(p);
    }
}

Error crossed_outline() {
  return Error(ErrorCode::scene, "outline of the sheet", "The outline crosses or touches itself.",
               "Repair the sheet mesh in the DCC.");
}

std::optional<Triangles> triangulate(const Cloud& cloud) {
  return constrained_delaunay(cloud.points, cloud.border, cloud.chords);
}

}  // namespace

std::vector<char> are_required(const PatternMesh& mesh) {
  std::vector<char> required(mesh.vertices.rows(), 0);
  for (const int v : mesh.point_vertex) required[v] = 1;
  return required;
}

double equilateral_edge(const Pattern& pattern, int triangles) {
  return std::sqrt(area(pattern) / triangles / (std::sqrt(3.0) / 4));
}

std::optional<PatternMesh> try_mesh_pattern(const Pattern& pattern, double edge,
                                            const std::vector<Vector2d>& points, double turn,
                                            double border) {
  constexpr int smoothing_passes = 6;
  const double snap = 1e-6 * longer_side(pattern);
  Cloud cloud;
  cloud.polygons = coarse_border(pattern, edge, border, snap);
  // a coarsened border misses the required points on it, or cuts off those close to it: move them
  // onto the polygon; points beside one of its corners to the corner, or there would be a tiny edge
  std::vector<Vector2d> required = points;
  const std::vector<Vector2d> stops = crease_points(pattern.prescribed_creases);
  required.insert(required.end(), stops.begin(), stops.end());
  for (Vector2d& p : required) {
    const Vector2d onto = nearest_border_point(cloud.polygons, p);
    const bool beside =
        (nearest_border_point(pattern, p) - p).norm() <= snap || !contains(cloud.polygons, p);
    if (beside && (onto - p).norm() <= 0.03 * edge) p = onto;
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    Vector2d& p = required[k];
    const auto is_same = [&](const Vector2d& stop) { return (stop - p).norm() <= snap; };
    if (std::none_of(stops.begin(), stops.end(), is_same))
      p = corner_beside(cloud.polygons, p, 1e-3 * edge).value_or(p);
  }
  sample_border(cloud.polygons.outline, edge, required, snap, cloud);
  for (const auto& hole : cloud.polygons.holes) sample_border(hole, edge, required, snap, cloud);
  required.resize(points.size());
  add_required(required, snap, cloud);
  if (!pattern.prescribed_creases.empty()) add_folds(pattern.prescribed_creases, edge, snap, cloud);
  add_lattice(edge, turn, cloud);

  std::optional<Triangles> triangles = triangulate(cloud);
  for (int pass = 0; triangles && pass < smoothing_passes; ++pass) {
    smooth_points(*triangles, cloud.points, cloud.fixed);
    triangles = triangulate(cloud);
  }
  if (!triangles) return std::nullopt;
  PatternMesh mesh;
  mesh.vertices.resize(static_cast<int>(cloud.points.size()), 2);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) mesh.vertices.row(i) = cloud.points[i];
  mesh.triangles = std::move(*triangles);
  mesh.point_vertex = std::move(cloud.point_vertex);
  return mesh;
}

PatternMesh mesh_pattern(const Pattern& pattern, double edge, const std::vector<Vector2d>& points,
                         double turn, double border) {
  std::optional<PatternMesh> mesh = try_mesh_pattern(pattern, edge, points, turn, border);
  if (!mesh) throw crossed_outline();
  return std::move(*mesh);
}

PatternMesh mesh_pattern_with(const Pattern& pattern, int triangles,
                              const std::vector<Vector2d>& points, double turn) {
  if (area(pattern) <= 0) throw crossed_outline();
  double edge = equilateral_edge(pattern, triangles);
  PatternMesh best = mesh_pattern(pattern, edge, points, turn);
  const auto miss = [&](const PatternMesh& m) {
    return std::abs(std::log(double(m.triangles.rows()) / triangles));
  };
  for (int k = 0; k < 6 && miss(best) > 0.02; ++k) {
    edge *= std::sqrt(double(best.triangles.rows()) / triangles);
    std::optional<PatternMesh> mesh = try_mesh_pattern(pattern, edge, points, turn);
    if (!mesh || miss(*mesh) >= miss(best)) break;
    best = std::move(*mesh);
  }
  return best;
}

int number_points_first(PatternMesh& mesh) {
  std::vector<int> number(mesh.vertices.rows(), -1);
  int next = 0;
  for (const int v : mesh.point_vertex)
    if (number[v] < 0) number[v] = next++;
  const int required = next;
  for (int& n : number)
    if (n < 0) n = next++;
  const Points2 old = mesh.vertices;
  for (int v = 0; v < old.rows(); ++v) mesh.vertices.row(number[v]) = old.row(v);
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) mesh.triangles(t, i) = number[mesh.triangles(t, i)];
  for (int& v : mesh.point_vertex) v = number[v];
  return required;
}

}  // namespace paperbake
