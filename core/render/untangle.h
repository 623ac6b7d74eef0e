#pragma once

#include "core/geometry/normal_cone_tree.h"
#include "core/model/sheet.h"
#include "core/render/render_mesh.h"

#include <functional>
#include <vector>

namespace paperbake {

/// Takes parts of a fine curved mesh out of each other: where they pass through each other it goes
/// back towards the facets of the simulated mesh, which do not.
///
///   x_v = (1 - s_v) x_v + s_v f_v + d_v,   s_v = max_u need_u k(|u - v| / R),   k(r) = (1 -
///   r^2)^2,   R = 8 edges
///
/// f     the same vertices on the facets
/// need  0; of the corners of triangles that pass through each other an eighth more, again and
///       again, until none do
/// d     0; beside a fold that runs across the edges of the fine mesh facets do not help: of
///       triangles within R of each other, and where need is 1, the point where an edge passes
///       through a triangle goes to its two places on the facets
///
/// Where the vertices on the facets, joined by the triangles of the fine mesh, do not pass through
/// each other, d is not needed and the end is sure: at the latest where all need is 1.
///
/// Vertices that are held stay.
class Untangler {
 public:
  Untangler(const Points2& pattern, const Triangles&);
  /// Of several meshes as of one: their vertices in a row, patterns side by side, each with edges
  /// of its own.
  explicit Untangler(const std::vector<const RenderMesh*>&);

  struct Outcome {
    bool changed;  // x was
    bool apart;    // nothing passes through anything any more
  };
  /// facets  |V|x3 [m];  facet_at  [m] of a point of the pattern; none: the end is sure without;  x
  ///         |V|x3 [m];  held  |V|.
  /// Several threads may ask at the same time.
  using FacetAt = std::function<Vector3d(const Vector2d&)>;
  Outcome operator()(Points3& x, const Points3& linear_positions, const FacetAt& facet_at,
                     const std::vector<char>& held) const;

  /// The same without facet_at, and in turns with what brings lengths back; of the turns' ends the
  /// one with the best lengths.
  struct Lengths {
    std::function<void(Points3& x)> restore;
    std::function<double(const Points3& x)> worst;  // [1] of an edge
  };
  Outcome untangle_alternating(Points3& x, const Points3& linear_positions, const Lengths&,
                               const std::vector<char>& held) const;

  /// Some triangles do, of those that the tree finds near each other.
  bool pass_through_each_other(const Points3& x) const;

  const NormalConeTree& tree() const { return tree_; }

 private:
  struct Push;
  void push(int s, int t, const Points3& x, const FacetAt&, Push&) const;
  void spread(int u, double blend, std::vector<char>& seen, std::vector<double>& weight) const;
  void find_neighbours();

  Points2 pattern_;
  Triangles triangles_;
  NormalConeTree tree_;
  std::vector<double> radius_;       // [m] R of each vertex
  std::vector<int> start_, beside_;  // neighbours of each vertex
};

/// A surface that leaves the triangles of a sheet by no more than `off` (|T| [m]) might pass
/// through itself: two of them are near enough, or neighbours folded by more than 120 degrees.
bool may_meet_itself(const Sheet&, const Eigen::VectorXd& off);

}  // namespace paperbake
