#include "core/render/untangle.h"

#include "core/geometry/measure.h"
#include "core/geometry/mesh_edges.h"
#include "core/geometry/proximity.h"
#include "core/geometry/swept_box_pairs.h"

#include <algorithm>
#include <set>

namespace paperbake {
namespace {

constexpr int rounds = 60;
constexpr double more = 0.125;  // [1] by how much blend rises in a round
constexpr double radius = 8;    // [edges] R

/// True if all corners of p that do not lie in the plane of q are on one side of it.
bool beside(const TriangleCorners& p, const TriangleCorners& q) {
  const Vector3d n = (q[1] - q[0]).cross(q[2] - q[0]);
  const double a = n.dot(p[0] - q[0]), b = n.dot(p[1] - q[0]), c = n.dot(p[2] - q[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

bool cross(const Points3& x, const Triangles& triangles, int s, int t) {
  const TriangleCorners p = corners_of(x, triangles, s), q = corners_of(x, triangles, t);
  for (int k = 0; k < 3; ++k)
    if (std::max({p[0][k], p[1][k], p[2][k]}) < std::min({q[0][k], q[1][k], q[2][k]}) ||
        std::max({q[0][k], q[1][k], q[2][k]}) < std::min({p[0][k], p[1][k], p[2][k]}))
      return false;
  return !beside(p, q) && !beside(q, p) && pierce_each_other(x, triangles, s, t);
}

/// The patterns of several meshes in a row, with gaps wider than the patterns. [m]
Points2 side_by_side(const std::vector<const RenderMesh*>& meshes) {
  long vertices = 0;
  for (const RenderMesh* mesh : meshes) vertices += mesh->pattern.rows();
  Points2 all(vertices, 2);
  long from = 0;
  double x = 0;
  for (const RenderMesh* mesh : meshes) {
    const Eigen::RowVector2d low = mesh->pattern.colwise().minCoeff(),
                             size = mesh->pattern.colwise().maxCoeff() - low;
    x += size.x();
    all.middleRows(from, mesh->pattern.rows()) =
        mesh->pattern.rowwise() + (Eigen::RowVector2d(x, 0) - low);
    x += 2 * size.x();
    from += mesh->pattern.rows();
  }
  return all;
}

Triangles in_a_row(const std::vector<const RenderMesh*>& meshes) {
  long triangles = 0;
  for (const RenderMesh* mesh : meshes) triangles += mesh->triangles.rows();
  Triangles all(triangles, 3);
  long from = 0, vertices = 0;
  for (const RenderMesh* mesh : meshes) {
    all.middleRows(from, mesh->triangles.rows()) =
        mesh->triangles.array() + static_cast<int>(vertices);
    from += mesh->triangles.rows();
    vertices += mesh->pattern.rows();
  }
  return all;
}

}  // namespace

bool may_meet_itself(const Sheet& sheet, const Eigen::VectorXd& off) {
  // [1] cosine of the angle between the normals of two triangles with a common vertex
  constexpr double sharp = -0.5;
  SweptBoxPairs triangles(sheet.triangles);
  for (const auto& [a, b] :
       triangles.find(sheet.x, Points3::Zero(sheet.x.rows(), 3), off.maxCoeff())) {
    const TriangleCorners p = corners_of(sheet.x, sheet.triangles, a),
                          q = corners_of(sheet.x, sheet.triangles, b);
    bool neighbours = false;
    for (int i = 0; i < 3; ++i)
      neighbours |= (sheet.triangles.row(b).array() == sheet.triangles(a, i)).any();
    const Vector3d n = (p[1] - p[0]).cross(p[2] - p[0]), m = (q[1] - q[0]).cross(q[2] - q[0]);
    if (neighbours ? n.dot(m) < sharp * n.norm() * m.norm()
                   : feature_distance(p, q) < off[a] + off[b])
      return true;
  }
  return false;
}

Untangler::Untangler(const Points2& pattern, const Triangles& triangles)
    : pattern_(pattern),
      triangles_(triangles),
      tree_(pattern, triangles),
      crossings_(pattern, triangles),
      radius_(pattern.rows(), radius * mean_edge(pattern, triangles)) {
  find_neighbours();
}

Untangler::Untangler(const std::vector<const RenderMesh*>& meshes)
    : Untangler(side_by_side(meshes), in_a_row(meshes)) {
  std::size_t v = 0;
  for (const RenderMesh* mesh : meshes) {
    const double of_mesh = radius * mean_edge(mesh->pattern, mesh->triangles);
    for (long k = 0; k < mesh->pattern.rows(); ++k) radius_[v++] = of_mesh;
  }
}

void Untangler::find_neighbours() {
  start_.assign(pattern_.rows() + 1, 0);
  std::vector<std::pair<int, int>> sides;
  for (const MeshEdge& e : MeshEdges(triangles_)) {
    sides.emplace_back(e.low, e.high);
    sides.emplace_back(e.high, e.low);
  }
  std::sort(sides.begin(), sides.end());
  for (const auto& [a, b] : sides) {
    ++start_[a + 1];
    beside_.push_back(b);
  }
  for (std::size_t v = 1; v < start_.size(); ++v) start_[v] += start_[v - 1];
}

void Untangler::spread(int u, double blend, std::vector<char>& seen,
                       std::vector<double>& weight) const {
  const double r = radius_[u];
  std::vector<int> reached{u};
  seen[u] = 1;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const int v = reached[k];
    const double r2 = (pattern_.row(v) - pattern_.row(u)).squaredNorm() / (r * r);
    weight[v] = std::max(weight[v], blend * (1 - r2) * (1 - r2));
    for (int e = start_[v]; e < start_[v + 1]; ++e) {
      const int w = beside_[e];
      if ((pattern_.row(w) - pattern_.row(u)).squaredNorm() >= r * r || seen[w]) continue;
      seen[w] = 1;
      reached.push_back(w);
    }
  }
  for (const int v : reached) seen[v] = 0;
}

std::size_t Untangler::add_left(const Points3& x, std::vector<std::pair<int, int>>& pairs) const {
  const std::vector<std::pair<int, int>> left = intersections(x);
  if (left.empty()) return 0;
  std::set<std::pair<int, int>> known;
  for (const auto& [s, t] : pairs) known.emplace(std::min(s, t), std::max(s, t));
  for (const auto& [s, t] : left)
    if (known.emplace(std::min(s, t), std::max(s, t)).second) pairs.emplace_back(s, t);
  return left.size();
}

bool Untangler::may_go_back(int s, int t, const std::vector<double>& blend) const {
  bool may_rise = (pattern_.row(triangles_(s, 0)) - pattern_.row(triangles_(t, 0))).norm() >
                  radius_[triangles_(s, 0)];
  for (int i = 0; i < 3; ++i)
    may_rise &= blend[triangles_(s, i)] < 1 && blend[triangles_(t, i)] < 1;
  return may_rise;
}

struct Untangler::Push {
  Points3 sum;                 // |V|x3 [m]
  std::vector<double> weight;  // |V|
};

/// Adds the displacements d of all points where the edges of s pass through t.
void Untangler::push(int s, int t, const Points3& x, const FlatAt& flat_at, Push& push) const {
  const TriangleCorners p = corners_of(x, triangles_, s), q = corners_of(x, triangles_, t);
  const Vector3d n = (q[1] - q[0]).cross(q[2] - q[0]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, a = triangles_(s, i), b = triangles_(s, j);
    if (!pierces(p[i], p[j], q)) continue;
    const double above = n.dot(p[i] - q[0]), u = above / (above - n.dot(p[j] - q[0]));
    const Vector3d at = (1 - u) * p[i] + u * p[j];
    Vector3d w;
    for (int k = 0; k < 3; ++k)
      w[k] = n.dot((q[(k + 1) % 3] - at).cross(q[(k + 2) % 3] - at)) / n.squaredNorm();
    Vector2d of_t = Vector2d::Zero();
    for (int k = 0; k < 3; ++k) of_t += w[k] * pattern_.row(triangles_(t, k)).transpose();
    const Vector3d edge_move = flat_at((1 - u) * pattern_.row(a).transpose() +
                                       u * pattern_.row(b).transpose()) -
                               at,
                   face_move = flat_at(of_t) - at;
    const auto add = [&](int v, double weight, const Vector3d& move, double square) {
      push.sum.row(v) += weight * (weight / square * move).transpose();
      push.weight[v] += weight;
    };
    add(a, 1 - u, edge_move, (1 - u) * (1 - u) + u * u);
    add(b, u, edge_move, (1 - u) * (1 - u) + u * u);
    for (int k = 0; k < 3; ++k) add(triangles_(t, k), w[k], face_move, w.squaredNorm());
  }
}

Untangler::Outcome Untangler::operator()(Points3& x, const Points3& linear_positions,
                                         const FlatAt& flat_at,
                                         const std::vector<char>& held) const {
  std::vector<std::pair<int, int>> candidates = tree_.near(x, linear_positions);
  const int vertices = static_cast<int>(x.rows());
  const Points3 curved = x;
  Points3 pushed = Points3::Zero(vertices, 3);
  std::vector<double> blend(vertices, 0), weight(vertices, 0);
  // `moved` and `crossed` are those of the last round
  std::vector<char> seen(vertices, 0), moved(vertices, 1), crossed(candidates.size(), 0);
  const auto has_any = [this](const std::vector<char>& of_vertices, int t) {
    return of_vertices[triangles_(t, 0)] || of_vertices[triangles_(t, 1)] ||
           of_vertices[triangles_(t, 2)];
  };
  for (int round = 0;; ++round) {
    bool any = false;
    std::vector<int> raised;
    std::vector<char> raising(vertices, 0);
    Push now{Points3::Zero(vertices, 3), std::vector<double>(vertices, 0)};
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const auto [s, t] = candidates[k];
      if (!has_any(moved, s) && !has_any(moved, t) && !crossed[k]) continue;
      crossed[k] = cross(x, triangles_, s, t);
      if (!crossed[k]) continue;
      any = true;
      if (flat_at && !may_go_back(s, t, blend)) {
        push(s, t, x, flat_at, now);
        push(t, s, x, flat_at, now);
        continue;
      }
      for (int i = 0; i < 3; ++i)
        for (const int v : {triangles_(s, i), triangles_(t, i)})
          if (!raising[v] && blend[v] < 1) {
            raising[v] = 1;
            raised.push_back(v);
          }
    }
    if (!any) {
      const std::size_t known = candidates.size(), left = add_left(x, candidates);
      if (candidates.size() == known) return {round > 0, left};
      crossed.resize(candidates.size(), 1);
      continue;
    }
    if (flat_at ? round == rounds : raised.empty()) return {round > 0, intersections(x).size()};
    for (const int v : raised) {
      blend[v] = round < rounds ? std::min(1.0, std::max(blend[v], weight[v]) + more) : 1;
      spread(v, blend[v], seen, weight);
    }
    for (int v = 0; v < vertices; ++v) {
      moved[v] = 0;
      if (held[v]) continue;
      if (now.weight[v] > 0) pushed.row(v) += now.sum.row(v) / now.weight[v];
      const Eigen::RowVector3d to =
          (1 - weight[v]) * curved.row(v) + weight[v] * linear_positions.row(v) + pushed.row(v);
      moved[v] = to != x.row(v);
      x.row(v) = to;
    }
  }
}

Untangler::Outcome Untangler::untangle_alternating(Points3& x, const Points3& linear_positions,
                                                   const Lengths& lengths,
                                                   const std::vector<char>& held) const {
  constexpr int max_turns = 6;
  const Outcome first = (*this)(x, linear_positions, {}, held);
  if (!first.changed) return first;
  Points3 now = x;
  double least = lengths.worst(x);
  Outcome best = first;
  std::size_t left = first.left;
  for (int turn = 0; turn < max_turns; ++turn) {
    lengths.restore(now);
    const Outcome outcome = (*this)(now, linear_positions, {}, held);
    const double worst = lengths.worst(now);
    if (outcome.left < best.left || (outcome.left == best.left && worst < least)) {
      least = worst;
      best.left = outcome.left;
      x = now;
    }
    if (!outcome.changed || (left > 0 && outcome.left >= left)) break;
    left = outcome.left;
  }
  return best;
}

}  // namespace paperbake
