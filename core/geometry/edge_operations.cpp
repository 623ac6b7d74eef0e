#include "core/geometry/edge_operations.h"

#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"
#include "core/geometry/proximity.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace paperbake {
namespace {

constexpr double max_compression = 0.03, max_new_fold = 2.2;  // [1], [rad]
constexpr double clearance = 0.005;                           // [1] of the length of a new edge

/// An edge a -> b with the triangle on its left and, inside the sheet, the one on its right.
struct Edge {
  int a, b;
  std::array<int, 2> triangles, wings;  // -1: border
  double length;                        // in the metric
};

std::vector<Edge> edges_of(const Sheet& sheet, const Points3& metric) {
  const Hinges hinges = find_hinges(sheet.triangles);
  std::vector<Edge> edges;
  for (const Hinge& h : hinges.hinges)
    edges.push_back({h.vertices[0], h.vertices[1], h.triangles, {h.vertices[2], h.vertices[3]}, 0});
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      if (hinges.of_triangle[t][i] < 0)
        edges.push_back({sheet.triangles(t, (i + 1) % 3),
                         sheet.triangles(t, (i + 2) % 3),
                         {t, -1},
                         {sheet.triangles(t, i), -1},
                         0});
  for (Edge& e : edges) e.length = metric_length(sheet, metric, e.a, e.b);
  return edges;
}

Vector2d at(const Sheet& sheet, int v) { return sheet.pattern.row(v); }

double twice_area(const Sheet& sheet, int a, int b, int c) {
  return cross(at(sheet, b) - at(sheet, a), at(sheet, c) - at(sheet, a));
}

/// Quality of a triangle in the mean metric of its corners: 1 equilateral, 0 or less degenerate.
double quality(const Sheet& sheet, const Points3& metric, int a, int b, int c) {
  const Eigen::RowVector3d m = (metric.row(a) + metric.row(b) + metric.row(c)) / 3;
  const auto squared = [&](int i, int j) {
    const Vector2d d = at(sheet, j) - at(sheet, i);
    return m[0] * d.x() * d.x() + 2 * m[1] * d.x() * d.y() + m[2] * d.y() * d.y();
  };
  return 2 * std::sqrt(3.0) * twice_area(sheet, a, b, c) * std::sqrt(m[0] * m[2] - m[1] * m[1]) /
         (squared(a, b) + squared(b, c) + squared(c, a));
}

bool too_compressed(const Sheet& sheet, int a, int b) {
  return (sheet.x.row(a) - sheet.x.row(b)).norm() <
         (1 - max_compression) * (at(sheet, a) - at(sheet, b)).norm();
}

/// True if nothing of the sheet except `changing` lies in the tetrahedron or next to its edge
/// v2-v3.
bool has_room(const Sheet& sheet, const std::array<int, 4>& v, const std::vector<int>& changing) {
  const auto x = [&](int k) -> Vector3d { return sheet.x.row(v[k]); };
  return tetrahedron_is_empty(sheet, v, {x(0), x(1), x(2), x(3)}, changing,
                              clearance * (x(2) - x(3)).norm());
}

/// True if the angles opposite the edge v0-v1 add up to more than pi in the metric, by a margin.
bool wants_to_flip(const Sheet& sheet, const Points3& metric, const std::array<int, 4>& v) {
  // [1] sine: with nearly equal diagonals an edge does not flip back and forth
  constexpr double margin = 0.1;
  const Eigen::RowVector3d m =
      0.25 * (metric.row(v[0]) + metric.row(v[1]) + metric.row(v[2]) + metric.row(v[3]));
  const Eigen::LLT<Eigen::Matrix2d> root(symmetric_matrix(m));
  const auto p = [&](int k) -> Vector2d { return root.matrixU() * at(sheet, v[k]); };
  const Vector2d a = p(0) - p(2), b = p(1) - p(2), c = p(1) - p(3), d = p(0) - p(3);
  // of the sum of the angles at both wings
  const double sine = cross(a, b) * c.dot(d) + a.dot(b) * cross(c, d);
  return sine < -margin * a.norm() * b.norm() * c.norm() * d.norm();
}

bool may_flip(const Sheet& sheet, const std::array<int, 4>& v, double least_share) {
  const double left = twice_area(sheet, v[0], v[3], v[2]),
               right = twice_area(sheet, v[3], v[1], v[2]);
  if (std::min(left, right) < least_share * (left + right) || too_compressed(sheet, v[2], v[3]))
    return false;
  // corner 0 is on the left of 3 -> 2
  return std::abs(dihedral_angle(sheet.x, Hinge{{v[3], v[2], v[0], v[1]}, {0, 0}})) <= max_new_fold;
}

template <class Matrix>
void drop_rows(Matrix& m, const std::vector<char>& gone) {
  int next = 0;
  for (int r = 0; r < m.rows(); ++r)
    if (!gone[r]) m.row(next++) = m.row(r).eval();
  m.conservativeResize(next, Eigen::NoChange);
}

/// The mesh during a round of collapses: the triangles around each vertex, and what has changed.
class Collapses {
 public:
  Collapses(Sheet& sheet, const Points3& metric, const std::vector<char>& kept, double longest)
      : sheet_(sheet),
        metric_(metric),
        kept_(kept),
        longest_(longest),
        ring_(sheet.pattern.rows()),
        border_(sheet.pattern.rows(), 0),
        folded_(border_),
        touched_(sheet.triangles.rows(), 0),
        dead_(sheet.triangles.rows(), 0),
        gone_(sheet.pattern.rows(), 0) {
    for (int t = 0; t < sheet.triangles.rows(); ++t)
      for (int i = 0; i < 3; ++i) ring_[sheet.triangles(t, i)].push_back(t);
  }

  int run() {
    std::vector<Edge> edges = edges_of(sheet_, metric_);
    for (const Edge& e : edges) {
      if (e.triangles[1] < 0) border_[e.a] = border_[e.b] = 1;
      if (is_on_crease(sheet_.prescribed_creases, sheet_.pattern, e.a, e.b))
        folded_[e.a] = folded_[e.b] = 1;
    }
    std::stable_sort(edges.begin(), edges.end(),
                     [](const Edge& a, const Edge& b) { return a.length < b.length; });
    int collapsed = 0;
    for (const Edge& e : edges) {
      if (e.length >= longest_) break;
      if (may_go(e.a, e.b, e)) {
        collapse(e.a, e.b);
        ++collapsed;
      } else if (may_go(e.b, e.a, e)) {
        collapse(e.b, e.a);
        ++collapsed;
      }
    }
    return collapsed;
  }

  void clear_away(Points3& metric) {
    std::vector<int> number(gone_.size());
    int next = 0;
    for (std::size_t v = 0; v < gone_.size(); ++v) number[v] = gone_[v] ? -1 : next++;
    drop_rows(sheet_.triangles, dead_);
    for (int t = 0; t < sheet_.triangles.rows(); ++t)
      for (int i = 0; i < 3; ++i) sheet_.triangles(t, i) = number[sheet_.triangles(t, i)];
    drop_rows(sheet_.pattern, gone_);
    drop_rows(sheet_.x, gone_);
    drop_rows(sheet_.v, gone_);
    drop_rows(metric, gone_);
  }

 private:
  bool untouched(int v) const {
    return std::none_of(ring_[v].begin(), ring_[v].end(), [&](int t) { return touched_[t]; });
  }

  std::vector<int> neighbours(int v) const {
    std::vector<int> found;
    for (const int t : ring_[v])
      for (int i = 0; i < 3; ++i)
        if (sheet_.triangles(t, i) != v) found.push_back(sheet_.triangles(t, i));
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// True if the border keeps its shape: the vertex is inside, or slides along a straight part.
  bool border_stays(int from, int to, const Edge& edge) const {
    constexpr double straight = 1e-9;  // [1] sine of the turn
    if (!border_[from]) return true;
    if (edge.triangles[1] >= 0) return false;
    for (const int t : ring_[from])
      for (int i = 0; i < 3; ++i) {
        const int other = sheet_.triangles(t, i);
        if (other == from || other == to || !border_[other] || shared(from, other) != 1) continue;
        const Vector2d in = (at(sheet_, from) - at(sheet_, other)).normalized(),
                       out = (at(sheet_, to) - at(sheet_, from)).normalized();
        return std::abs(cross(in, out)) < straight && in.dot(out) > 0;
      }
    return false;
  }

  /// Number of triangles that have this edge.
  int shared(int a, int b) const {
    return static_cast<int>(std::count_if(ring_[a].begin(), ring_[a].end(), [&](int t) {
      return (sheet_.triangles.row(t).array() == b).any();
    }));
  }

  bool may_go(int from, int to, const Edge& edge) const {
    if (kept_[from] || folded_[from] || !untouched(from) || !untouched(to) ||
        !border_stays(from, to, edge))
      return false;
    // the two have no common neighbours except the wings of their edge
    const std::vector<int> mine = neighbours(from), theirs = neighbours(to);
    std::vector<int> common;
    std::set_intersection(mine.begin(), mine.end(), theirs.begin(), theirs.end(),
                          std::back_inserter(common));
    if (common.size() != (edge.triangles[1] < 0 ? 1u : 2u)) return false;
    for (const int n : mine)
      if (n != to && metric_length(sheet_, metric_, n, to) >= longest_) return false;
    return shapes_stay_good(from, to);
  }

  bool shapes_stay_good(int from, int to) const {
    // [1] the worst quality afterwards: `good` at least, or this share of what it was before, and
    // never as little as `flat`; assumed
    constexpr double good = 0.3, not_worse = 0.9, flat = 0.05;
    double worst_before = 1, worst = 1;
    std::vector<std::array<int, 3>> kept;  // to, b, c of each triangle that stays
    for (const int t : ring_[from]) {
      const int i = sheet_.triangles(t, 0) == from ? 0 : sheet_.triangles(t, 1) == from ? 1 : 2;
      const int b = sheet_.triangles(t, (i + 1) % 3), c = sheet_.triangles(t, (i + 2) % 3);
      worst_before = std::min(worst_before, quality(sheet_, metric_, from, b, c));
      if (b == to || c == to) continue;
      kept.push_back({to, b, c});
      worst = std::min(worst, quality(sheet_, metric_, to, b, c));
    }
    if (kept.empty() || worst <= flat || (worst < good && worst < not_worse * worst_before))
      return false;
    for (const auto& [v, b, c] : kept) {
      if (too_compressed(sheet_, v, b) || too_compressed(sheet_, v, c)) return false;
      const Vector3d n = normal(v, b, c);
      for (const auto& [w, d, e] : kept)
        if (n.dot(normal(w, d, e)) < std::cos(max_new_fold)) return false;
    }
    return std::all_of(kept.begin(), kept.end(), [&](const std::array<int, 3>& k) {
      return has_room(sheet_, {from, k[2], to, k[1]}, ring_[from]);
    });
  }

  Vector3d normal(int a, int b, int c) const {
    return triangle_normal(sheet_.x.row(a), sheet_.x.row(b), sheet_.x.row(c));
  }

  void collapse(int from, int to) {
    gone_[from] = 1;
    for (const int t : ring_[from]) {
      touched_[t] = 1;
      if ((sheet_.triangles.row(t).array() == to).any()) {
        dead_[t] = 1;
        continue;
      }
      for (int i = 0; i < 3; ++i)
        if (sheet_.triangles(t, i) == from) sheet_.triangles(t, i) = to;
    }
  }

  Sheet& sheet_;
  const Points3& metric_;
  const std::vector<char>& kept_;
  double longest_;
  std::vector<std::vector<int>> ring_;  // triangles of each vertex
  std::vector<char> border_, folded_, touched_, dead_, gone_;
};

}  // namespace

double metric_length(const Sheet& sheet, const Points3& metric, int a, int b) {
  const Vector2d d = (sheet.pattern.row(b) - sheet.pattern.row(a)).transpose();
  const Eigen::RowVector3d m = 0.5 * (metric.row(a) + metric.row(b));
  return std::sqrt(m[0] * d.x() * d.x() + 2 * m[1] * d.x() * d.y() + m[2] * d.y() * d.y());
}

Misfit misfit(const Sheet& sheet, const Points3& metric) {
  Misfit m;
  const std::vector<Edge> edges = edges_of(sheet, metric);
  for (const Edge& e : edges) {
    m.longest = std::max(m.longest, e.length);
    m.too_long += (e.length > 1) / double(edges.size());
  }
  return m;
}

int split_long_edges(Sheet& sheet, Points3& metric, int max_triangles) {
  std::vector<Edge> edges = edges_of(sheet, metric);
  edges.erase(
      std::remove_if(edges.begin(), edges.end(), [](const Edge& e) { return e.length <= 1; }),
      edges.end());
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& a, const Edge& b) { return a.length > b.length; });
  const int vertices = static_cast<int>(sheet.pattern.rows());
  int triangles = static_cast<int>(sheet.triangles.rows());
  std::vector<char> touched(triangles, 0);
  std::vector<Edge> chosen;
  for (const Edge& e : edges) {
    const int more = e.triangles[1] < 0 ? 1 : 2;
    if (touched[e.triangles[0]] || (more == 2 && touched[e.triangles[1]]) ||
        triangles + more > max_triangles)
      continue;
    triangles += more;
    for (const int t : e.triangles)
      if (t >= 0) touched[t] = 1;
    chosen.push_back(e);
  }
  int next_vertex = vertices, next_triangle = static_cast<int>(sheet.triangles.rows());
  const int all = vertices + static_cast<int>(chosen.size());
  sheet.triangles.conservativeResize(triangles, Eigen::NoChange);
  sheet.pattern.conservativeResize(all, Eigen::NoChange);
  for (Points3* rows : {&sheet.x, &sheet.v, &metric})
    rows->conservativeResize(all, Eigen::NoChange);
  for (const Edge& e : chosen) {
    const int m = next_vertex++;
    sheet.pattern.row(m) = 0.5 * (sheet.pattern.row(e.a) + sheet.pattern.row(e.b));
    for (Points3* rows : {&sheet.x, &sheet.v, &metric})
      rows->row(m) = 0.5 * (rows->row(e.a) + rows->row(e.b)).eval();
    const int a = e.a, b = e.b;
    sheet.triangles.row(e.triangles[0]) << a, m, e.wings[0];
    sheet.triangles.row(next_triangle++) << m, b, e.wings[0];
    if (e.triangles[1] < 0) continue;
    sheet.triangles.row(e.triangles[1]) << m, a, e.wings[1];
    sheet.triangles.row(next_triangle++) << b, m, e.wings[1];
  }
  return static_cast<int>(chosen.size());
}

int flip_edges(Sheet& sheet, double least_share, const std::function<bool(const Hinge&)>& wants) {
  constexpr int rounds = 6;
  int flips = 0;
  for (int round = 0; round < rounds; ++round) {
    const int before = flips;
    std::vector<char> touched(sheet.triangles.rows(), 0);
    for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
      const auto [left, right] = hinge.triangles;
      const auto& v = hinge.vertices;
      if (touched[left] || touched[right] ||
          is_on_crease(sheet.prescribed_creases, sheet.pattern, v[0], v[1]) || !wants(hinge) ||
          !may_flip(sheet, v, least_share) || !has_room(sheet, v, {left, right}))
        continue;
      sheet.triangles.row(left) << v[0], v[3], v[2];
      sheet.triangles.row(right) << v[3], v[1], v[2];
      touched[left] = touched[right] = 1;
      ++flips;
    }
    if (flips == before) break;
  }
  return flips;
}

int flip_to_delaunay(Sheet& sheet, const Points3& metric, double max_fold) {
  constexpr double least_share = 0.05;
  return flip_edges(sheet, least_share, [&](const Hinge& hinge) {
    return wants_to_flip(sheet, metric, hinge.vertices) &&
           std::abs(dihedral_angle(sheet.x, hinge)) <= max_fold;
  });
}

int collapse_short_edges(Sheet& sheet, Points3& metric, const std::vector<char>& kept,
                         double longest) {
  Collapses collapses(sheet, metric, kept, longest);
  const int gone = collapses.run();
  if (gone > 0) collapses.clear_away(metric);
  return gone;
}

}  // namespace paperbake
