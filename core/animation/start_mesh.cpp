#include "core/animation/start_mesh.h"

#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

namespace paperbake {
namespace {

constexpr double flat = 1e-3;       // [rad] an edge that turns less bends nothing
constexpr double collinear = 1e-3;  // [rad] largest angle between edges of one bend
// [1] by which an edge may be too short, where the layers of a sheet are as far apart as modelled
constexpr double longest_error = 2e-3;
constexpr double least_error = 1e-5;  // [1] the same where they would pass through each other
constexpr int more_triangles = 2000;  // [1] at most, than the method's own mesh has

/// The bent edges of a mesh that leave each of its vertices.
struct BentEdges {
  struct Edge {
    int a, b;     // vertices
    double turn;  // [rad]
  };
  std::vector<Edge> edges;
  std::vector<std::vector<int>> at;  // numbers of the edges at each vertex

  explicit BentEdges(const Sheet& start) : at(start.pattern.rows()) {
    for (const Hinge& hinge : find_hinges(start.triangles).hinges) {
      const double turn = std::abs(dihedral_angle(start.x, hinge));
      if (turn < flat) continue;
      for (const int end : {0, 1})
        at[hinge.vertices[end]].push_back(static_cast<int>(edges.size()));
      edges.push_back({hinge.vertices[0], hinge.vertices[1], turn});
    }
  }
};

/// Where two segments cross between their ends, as a fraction of the first.
std::optional<double> crossing(const Vector2d& a, const Vector2d& b, const Bend& bend) {
  constexpr double inside = 1e-6;  // [1]
  const std::optional<LinesMeet> meet =
      where_lines_meet({a, b - a}, {bend.a, bend.b - bend.a}, 1e-12);
  if (!meet) return std::nullopt;
  const auto [on_first, on_bend] = *meet;
  if (on_first <= inside || on_first >= 1 - inside || on_bend < -inside || on_bend > 1 + inside)
    return std::nullopt;
  return on_first;
}

/// Bends that become rows of edges, chosen round by round.
class BendChoice {
 public:
  BendChoice(const Shot& shot, const std::vector<Vector2d>& points)
      : start_(shot.start),
        locator_(start_.pattern, start_.triangles),
        points_(points),
        on_line_(1e-4 * longer_side(shot.pattern)),
        pattern_(shot.pattern) {
    const double near = 20 * on_line_;
    // between a point and a bend beside it there would be a needle
    const auto beside_a_point = [&](const Bend& bend) {
      return std::any_of(points.begin(), points.end(), [&](const Vector2d& p) {
        const double off = distance_to_segment(p, bend.a, bend.b);
        return off > on_line_ && off < near;
      });
    };
    for (const Bend& bend : bends_of(start_))
      if (!beside_a_point(bend)) bends_.push_back(bend);
  }

  bool any() const { return !bends_.empty(); }

  /// The pattern with the bends that are chosen, and those that another mesh of it asks for.
  /// Nothing when it asks for none.
  /// longest_error  [1] by which an edge of it may be too short
  std::optional<Pattern> next(const PatternMesh& mesh, double longest_error);

  /// How often a mesh crosses itself in the start shape.
  int crossings_on(const PatternMesh&) const;

 private:
  struct Chord {
    double error;  // [1] by which it is too short
    Vector2d a, b;
  };
  Points3 start_of(const PatternMesh&) const;
  std::vector<Chord> short_chords(const PatternMesh&, double longest_error) const;
  std::vector<Vector2d> line_of(const Bend&) const;

  const Sheet& start_;
  PointLocator locator_;
  const std::vector<Vector2d>& points_;
  double on_line_;           // [m] a bend goes through points that are no farther from it
  Pattern pattern_;          // its creases are followed by the bends that are chosen
  std::vector<Bend> bends_;  // that are not chosen yet
};

Points3 BendChoice::start_of(const PatternMesh& mesh) const {
  Points3 x(mesh.vertices.rows(), 3);
  for (int v = 0; v < x.rows(); ++v)
    x.row(v) = interpolate(locator_.locate(mesh.vertices.row(v)), start_.triangles, start_.x);
  return x;
}

int BendChoice::crossings_on(const PatternMesh& mesh) const {
  return CrossingCounter(mesh.vertices, mesh.triangles)(start_of(mesh));
}

std::vector<BendChoice::Chord> BendChoice::short_chords(const PatternMesh& mesh,
                                                        double longest_error) const {
  const Points3 x = start_of(mesh);
  std::vector<Chord> chords;
  for (const Hinge& hinge : find_hinges(mesh.triangles).hinges) {
    const auto [i, j, left, right] = hinge.vertices;
    const double length = (mesh.vertices.row(j) - mesh.vertices.row(i)).norm(),
                 error = 1 - (x.row(j) - x.row(i)).norm() / length;
    if (error > longest_error)
      chords.push_back({error, mesh.vertices.row(i), mesh.vertices.row(j)});
  }
  std::stable_sort(chords.begin(), chords.end(),
                   [](const Chord& a, const Chord& b) { return a.error > b.error; });
  return chords;
}

/// A bend as the polyline through the points that lie on it, but for rounding in the file.
std::vector<Vector2d> BendChoice::line_of(const Bend& bend) const {
  const Vector2d along = bend.b - bend.a;
  std::vector<Vector2d> line;
  for (const Vector2d& p : points_)
    if (distance_to_segment(p, bend.a, bend.b) <= on_line_) line.push_back(p);
  std::sort(line.begin(), line.end(),
            [&](const Vector2d& p, const Vector2d& q) { return along.dot(p) < along.dot(q); });
  if (line.empty() || (line.front() - bend.a).norm() > on_line_) line.insert(line.begin(), bend.a);
  if ((line.back() - bend.b).norm() > on_line_) line.push_back(bend.b);
  return line;
}

/// Of the bends that a short chord crosses, the one that has half of their turn on either side.
std::optional<Pattern> BendChoice::next(const PatternMesh& mesh, double longest_error) {
  std::set<std::size_t> chosen;
  for (const Chord& chord : short_chords(mesh, longest_error)) {
    std::vector<std::pair<double, std::size_t>> crossed;
    double turn = 0;
    bool divided = false;
    for (std::size_t k = 0; k < bends_.size() && !divided; ++k)
      if (const std::optional<double> at = crossing(chord.a, chord.b, bends_[k])) {
        crossed.emplace_back(*at, k);
        turn += bends_[k].turn;
        divided = chosen.count(k) > 0;
      }
    if (divided || crossed.empty()) continue;
    std::sort(crossed.begin(), crossed.end());
    double before = 0;
    for (const auto& [at, k] : crossed)
      if ((before += bends_[k].turn) >= 0.5 * turn) {
        chosen.insert(k);
        break;
      }
  }
  if (chosen.empty()) return std::nullopt;
  for (const std::size_t k : chosen) pattern_.prescribed_creases.push_back({line_of(bends_[k])});
  std::size_t k = 0;
  bends_.erase(std::remove_if(bends_.begin(), bends_.end(),
                              [&](const Bend&) { return chosen.count(k++) > 0; }),
               bends_.end());
  return pattern_;
}

}  // namespace

std::vector<Bend> bends_of(const Sheet& start) {
  const BentEdges bent(start);
  std::vector<char> used(bent.edges.size(), 0);
  const auto at = [&](int v) -> Vector2d { return start.pattern.row(v); };
  // goes on from vertex `to`, in the direction from `from` to it, as far as there are bent edges
  const auto far_end = [&](int from, int to, double& turn) {
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      const Vector2d along = at(to) - at(from);
      for (const int e : bent.at[to]) {
        const int next = bent.edges[e].a == to ? bent.edges[e].b : bent.edges[e].a;
        const Vector2d ahead = at(next) - at(to);
        if (used[e] || along.dot(ahead) <= 0 ||
            std::abs(cross(along, ahead)) > collinear * along.norm() * ahead.norm())
          continue;
        used[e] = 1;
        turn = std::max(turn, bent.edges[e].turn);
        from = std::exchange(to, next);
        goes_on = true;
        break;
      }
    }
    return to;
  };
  std::vector<Bend> bends;
  for (std::size_t e = 0; e < bent.edges.size(); ++e) {
    if (std::exchange(used[e], 1)) continue;
    double turn = bent.edges[e].turn;
    const int a = far_end(bent.edges[e].b, bent.edges[e].a, turn),
              b = far_end(bent.edges[e].a, bent.edges[e].b, turn);
    bends.push_back({at(a), at(b), turn});
  }
  std::stable_sort(bends.begin(), bends.end(), [](const Bend& p, const Bend& q) {
    return (p.b - p.a).norm() > (q.b - q.a).norm();
  });
  return bends;
}

StartMesh mesh_of_start(const Shot& shot, Method& method, const std::vector<Vector2d>& points) {
  StartMesh start{method.first_mesh(shot.pattern, points), false};
  BendChoice choice(shot, points);
  if (!choice.any()) return start;
  const auto most = more_triangles + start.mesh.triangles.rows();
  for (double error = longest_error; error > least_error; error /= 4) {
    while (const std::optional<Pattern> bent = choice.next(start.mesh, error)) {
      std::optional<PatternMesh> mesh = method.mesh_with_creases(*bent, points, 1);
      if (!mesh || mesh->triangles.rows() > most) return start;
      start = {std::move(*mesh), true};
    }
    if (choice.crossings_on(start.mesh) == 0 || crossings(shot.start) > 0) break;
  }
  return start;
}

}  // namespace paperbake
