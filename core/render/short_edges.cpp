#include "core/render/short_edges.h"

#include "core/geometry/mesh_edges.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <tuple>

namespace paperbake {
namespace {

/// A triangulation in which vertices are merged. Triangles that are gone have corners of -1.
class MergedMesh {
 public:
  using OnLine = std::function<bool(int, int)>;

  MergedMesh(const Points2& pattern, Triangles& triangles, const std::vector<char>& kept,
             const OnLine& on_line)
      : pattern_(pattern), triangles_(triangles), kept_(kept), on_line_(on_line) {
    around_.resize(pattern.rows());
    for (int t = 0; t < triangles.rows(); ++t)
      for (int i = 0; i < 3; ++i) around_[triangles(t, i)].insert(t);
  }

  /// Merges v with its neighbour u if the rules allow it.
  bool merge(int v, int u) {
    if (kept_[v] || !stays_on_its_lines(v, u) || !stays_a_mesh(v, u) || !stays_as_thick(v, u))
      return false;
    for (const int t : std::set<int>(around_[v])) {
      if (has(t, u)) {
        for (int i = 0; i < 3; ++i) around_[triangles_(t, i)].erase(t);
        triangles_.row(t).setConstant(-1);
      } else {
        for (int i = 0; i < 3; ++i)
          if (triangles_(t, i) == v) triangles_(t, i) = u;
        around_[u].insert(t);
      }
    }
    around_[v].clear();
    return true;
  }

 private:
  bool has(int t, int v) const { return (triangles_.row(t).array() == v).any(); }

  int triangles_at(int a, int b) const {
    return static_cast<int>(
        std::count_if(around_[a].begin(), around_[a].end(), [&](int t) { return has(t, b); }));
  }

  std::set<int> neighbours(int v) const {
    std::set<int> found;
    for (const int t : around_[v])
      for (int i = 0; i < 3; ++i)
        if (triangles_(t, i) != v) found.insert(triangles_(t, i));
    return found;
  }

  bool is_border(int a, int b) const { return triangles_at(a, b) == 1; }

  /// On lines, v may go to u if it lies between u and a third point of one straight line.
  bool stays_on_its_lines(int v, int u) const {
    std::vector<int> ends;
    for (const int n : neighbours(v))
      if (is_border(v, n) || on_line_(v, n)) ends.push_back(n);
    if (ends.empty()) return true;
    if (ends.size() != 2 || (ends[0] != u && ends[1] != u)) return false;
    const int far = ends[0] == u ? ends[1] : ends[0];
    return distance_to_segment(pattern_.row(v), pattern_.row(u), pattern_.row(far)) <=
           1e-9 * (pattern_.row(u) - pattern_.row(far)).norm();
  }

  /// Whether the mesh remains a surface: a closed fan of triangles, or half of one, is around every
  /// vertex.
  bool stays_a_mesh(int v, int u) const {
    const std::set<int> of_v = neighbours(v), of_u = neighbours(u);
    const auto common =
        std::count_if(of_v.begin(), of_v.end(), [&](int n) { return of_u.count(n) > 0; });
    return common == triangles_at(v, u);
  }

  /// Smallest height of a triangle; negative when it is turned over. [m]
  double height(int a, int b, int c) const {
    const Vector2d p = pattern_.row(a), q = pattern_.row(b), r = pattern_.row(c);
    const double longest = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
    return cross(q - p, r - p) / std::max(longest, std::numeric_limits<double>::min());
  }

  bool stays_as_thick(int v, int u) const {
    double before = std::numeric_limits<double>::infinity(), after = before;
    for (const int t : around_[v]) {
      std::array<int, 3> corner{triangles_(t, 0), triangles_(t, 1), triangles_(t, 2)};
      before = std::min(before, height(corner[0], corner[1], corner[2]));
      if (has(t, u)) continue;
      std::replace(corner.begin(), corner.end(), v, u);
      after = std::min(after, height(corner[0], corner[1], corner[2]));
    }
    return after > 0 && after >= before;
  }

  const Points2& pattern_;
  Triangles& triangles_;
  const std::vector<char>& kept_;
  const OnLine& on_line_;
  std::vector<std::set<int>> around_;  // triangles of each vertex
};

/// Leaves out what was merged, and says where the vertices are now.
std::vector<int> without_merged(Points2& pattern, Triangles& triangles,
                                const std::vector<int>& became) {
  std::vector<int> place(pattern.rows(), -1);
  int vertices = 0;
  for (int v = 0; v < pattern.rows(); ++v) {
    if (became[v] != v) continue;
    pattern.row(vertices) = pattern.row(v).eval();
    place[v] = vertices++;
  }
  pattern.conservativeResize(vertices, Eigen::NoChange);
  int left = 0;
  for (int t = 0; t < triangles.rows(); ++t) {
    if (triangles(t, 0) < 0) continue;
    for (int i = 0; i < 3; ++i) triangles(left, i) = place[triangles(t, i)];
    ++left;
  }
  triangles.conservativeResize(left, Eigen::NoChange);
  std::vector<int> now(became.size());
  for (std::size_t v = 0; v < became.size(); ++v) {
    int last = static_cast<int>(v);
    while (place[last] < 0) last = became[last];
    now[v] = place[last];
  }
  return now;
}

}  // namespace

std::vector<int> merge_short_edges(Points2& pattern, Triangles& triangles,
                                   const std::vector<char>& kept,
                                   const std::function<bool(int, int)>& on_line, double shortest) {
  std::vector<std::tuple<double, int, int>> edges;
  for (const MeshEdge& e : MeshEdges(triangles))
    if (const double length = (pattern.row(e.low) - pattern.row(e.high)).norm(); length < shortest)
      edges.emplace_back(length, e.low, e.high);
  std::sort(edges.begin(), edges.end());
  std::vector<int> became(pattern.rows());
  for (int v = 0; v < pattern.rows(); ++v) became[v] = v;
  if (edges.empty()) return became;
  MergedMesh mesh(pattern, triangles, kept, on_line);
  for (const auto& [length, a, b] : edges) {
    if (became[a] != a || became[b] != b) continue;
    if (mesh.merge(b, a))
      became[b] = a;
    else if (mesh.merge(a, b))
      became[a] = b;
  }
  return without_merged(pattern, triangles, became);
}

}  // namespace paperbake
