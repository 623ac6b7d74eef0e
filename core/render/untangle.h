#pragma once

#include "core/geometry/intersections.h"
#include "core/geometry/normal_cone_tree.h"
#include "core/model/sheet.h"
#include "core/render/render_mesh.h"

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace paperbake {

/// Separates parts of a fine curved mesh that pass through each other: they go back towards the
/// flat triangles of the simulated mesh, which do not.
///
///   x_v = (1 - s_v) x_v + s_v f_v + d_v,   s_v = max_u blend_u k(|u - v| / R),
///   k(r) = (1 - r^2)^2,   R = 8 edges
///
/// f      the same vertices on the flat triangles
/// blend  0 at first; at the corners of triangles that pass through each other it rises by an
///        eighth, again and again, until none of them do
/// d      0, except where a fold runs across the edges of the fine mesh, so that the flat triangles
///        do not help: for triangles within R of each other, and where blend is 1, the point where
///        an edge passes through a triangle goes to its two places on the flat triangles
///
/// Where the vertices on the flat triangles, joined by the triangles of the fine mesh, do not pass
/// through each other, d is not needed and success is certain, at the latest when blend is 1
/// everywhere.
///
/// Vertices that are held stay where they are.
class Untangler {
 public:
  Untangler(const Points2& pattern, const Triangles&);
  /// Treats several meshes as one: their vertices are numbered one mesh after the other and their
  /// patterns lie side by side. Every mesh has its own R.
  explicit Untangler(const std::vector<const RenderMesh*>&);

  struct Outcome {
    bool changed;      // whether x was changed
    std::size_t left;  // pairs of triangles that pass through each other still
    bool apart() const { return left == 0; }
  };
  /// linear_positions  |V|x3 [m] f
  /// flat_at   [m] where a point of the pattern is on the flat triangles; empty: d is 0
  /// x         |V|x3 [m]
  /// held      |V|
  /// May be called by several threads at the same time.
  using FlatAt = std::function<Vector3d(const Vector2d&)>;
  Outcome operator()(Points3& x, const Points3& linear_positions, const FlatAt& flat_at,
                     const std::vector<char>& held) const;

  /// The same without flat_at, alternating with a step that restores lengths. Of the rounds with
  /// the fewest pairs left, the one with the best lengths is kept.
  struct Lengths {
    std::function<void(Points3& x)> restore;
    std::function<double(const Points3& x)> worst;  // [1] largest length error of an edge
  };
  Outcome untangle_alternating(Points3& x, const Points3& linear_positions, const Lengths&,
                               const std::vector<char>& held) const;

  /// The pairs of triangles that pass through each other.
  std::vector<std::pair<int, int>> intersections(const Points3& x) const {
    return crossings_.pairs(x);
  }

 private:
  struct Push;
  void push(int s, int t, const Points3& x, const FlatAt&, Push&) const;
  /// Whether going back towards the flat triangles may part two triangles: not where they are
  /// within R of each other, or have gone back all the way.
  bool may_go_back(int s, int t, const std::vector<double>& blend) const;
  /// Adds the pairs that pass through each other and are not there yet. returns  how many do
  std::size_t add_left(const Points3& x, std::vector<std::pair<int, int>>& pairs) const;
  void spread(int u, double blend, std::vector<char>& seen, std::vector<double>& weight) const;
  void find_neighbours();

  Points2 pattern_;
  Triangles triangles_;
  NormalConeTree tree_;              // what may meet on the way; misses a few pairs
  CrossingCounter crossings_;        // finds these, too
  std::vector<double> radius_;       // [m] R of each vertex
  std::vector<int> start_, beside_;  // neighbours of each vertex
};

/// True if a surface that lies within `off` (|T| [m]) of the triangles of a sheet might pass
/// through itself: two of the triangles are near enough to each other, or two with a common vertex
/// are folded by more than 120 degrees.
bool may_meet_itself(const Sheet&, const Eigen::VectorXd& off);

}  // namespace paperbake
