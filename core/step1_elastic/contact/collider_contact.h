#pragma once

#include "core/geometry/collider_motion.h"
#include "core/geometry/proximity.h"
#include "core/linear_algebra/block_cholesky.h"
#include "core/step1_elastic/contact/collider_barrier.h"
#include "core/step1_elastic/contact/friction_history.h"
#include "core/step1_elastic/position_constraints.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace paperbake {

/// Contact of the mesh of one sheet with colliders: a term of the incremental potential.
///
/// There are contacts between a vertex of the sheet and the nearest point of a collider (more than
/// one point in a concave corner, as of a room); between an edge of the sheet and a convex edge of
/// the collider; and between a triangle of the sheet and a convex corner. Each has a signed
/// distance and pushes with `collider_barrier`. Friction is Coulomb's, with the forces, directions
/// and contact points of the beginning of the step [Li 2020]; a contact remembers its shear from
/// step to step (friction_history.h). A vertex that begins the step farther
/// than depth() behind an open collider has come round its border and belongs there.
class ColliderContact {
 public:
  ColliderContact(std::shared_ptr<const Colliders>, const Triangles&, int vertices);

  /// Begins a step of a sheet at x.
  /// held    vertices that are not solved for
  /// pulled  vertices that springs pull to targets. If the target lies closer than dhat to a
  ///         collider, the vertex is not pushed out from there: a hand that rests on a table needs
  ///         no force to stay.
  /// history what contacts remember of the step before
  void begin(const Points3& x, const ColliderMotion&, const std::vector<int>& held,
             const PositionConstraints& pulled = {}, const FrictionHistory& history = {});
  /// Writes the shear of every contact with friction at the end of the step.
  void remember(const Points3& y, FrictionHistory&) const;

  /// Replaces targets by the points where the vertices get to from the beginning of the step,
  /// carried along by moving colliders, and sliding along their surface where they are in the way.
  void project_outside(PositionConstraints&) const;
  /// The same for a target of every vertex; those of `held` vertices stay.
  /// to  |V|x3 [m]
  void project_outside(Points3& to);

  /// Fraction of the move after which no vertex is inside a collider, unless it was before, and no
  /// edge or corner has passed through.
  double collision_free_step(const Points3& y, const Points3& move);

  double energy(const Points3& y);  // [J]
  /// Returns the energy [J]. Adds its gradient [N] to `gradient`, and to the matrix the Hessians
  /// b'' w_i w_j n n^T of the barrier and that of friction [N/m], neither of which is ever
  /// indefinite.
  /// block_of  |V| block row of each vertex, -1: constrained
  double differentiate(const Points3& y, const std::vector<int>& block_of, Points3& gradient,
                       BlockCholesky* matrix);

  /// Moves the corners of every vertex, edge and triangle that is inside a collider, or closer to
  /// it than `clearance`, each by its share of the way out. One pass: what is pushed out may be
  /// pushed in elsewhere. Vertices have come in a straight line from where the step begins.
  /// held       |V| vertices that stay. The rest of an edge or a triangle makes up for them inside
  ///            a collider, but goes no farther than `clearance` outside of it.
  /// clearance  [m] less than collider_dhat
  void push_out(const std::vector<char>& held, double clearance, Points3& y);

  int touching(const Points3& y);   // number of active contacts
  double inside(const Points3& y);  // [m] depth of the deepest contact point; 0: none is inside
  /// [m] The same for open colliders, of a sheet that has come in a straight line from where the
  /// step begins.
  double cut_by_open(const Points3& y);

 private:
  static constexpr double tube = 1e-3;  // [m] how far vertices may move before lists are rebuilt
  static Vector3d row(const Points3& x, int v) { return x.row(v).transpose(); }
  struct SheetFeature {  // a vertex, an edge or a triangle of the sheet
    std::array<int, 3> vertices;
    int corners;
    // indices of triangles, edges or corners of the collider; of edges and corners those from which
    // the feature was no farther than it may be when the lists were made
    std::vector<int> near;
    // a box round the feature met some, whether they are that near or not: it may meet them soon
    bool is_close = false;
  };
  /// [m] of a feature; in place of those that a vertex or an edge lacks, the first one
  static TriangleCorners corners_of(const SheetFeature&, const Points3& x);
  struct ContactPoint {
    std::array<int, 3> vertices;
    std::array<double, 3> weights;
    int corners;
    Vector3d at, normal;  // of the collider
    double distance;
  };
  struct FeaturePair {  // an edge or a triangle, and a convex edge or corner of a collider
    std::array<double, 3> weights;
    Vector3d at, apart;  // separation: from `at` to the sheet
    double distance;
    enum { outside, inside, nearer_to_another } where;
  };
  struct FrictionContact {  // friction of one contact
    std::array<int, 3> vertices;
    std::array<double, 3> weights;
    int corners;
    Eigen::Matrix<double, 3, 2> along;
    Vector3d carried;  // [m] motion of the collider at this point in this step
    double force;      // [N] friction coefficient x normal force
    TouchingFeatures name;
    Eigen::Vector2d shear;  // [m] at the beginning of the step
  };
  struct ColliderState {  // the sheet against one collider
    std::vector<SheetFeature> features;
    std::vector<int> close;  // features with something of the collider nearby
    // |V|x3 [m] the lists are valid while vertices are this near to it; NaN: there are none yet
    Points3 reference;
    const Collider* of = nullptr;  // the shape for which the lists were made
    // |V| whether the vertex is a corner of an edge or a triangle of the sheet that an edge or a
    // corner of the moving collider may meet in this step
    std::vector<char> swept;
    double moved = 0;  // [m] by the collider in this step, at most
    // |V| -1: the vertex has come round the border of an open collider; otherwise 1
    std::vector<std::int8_t> side;
    // |V|x3 [m] where the vertices would be if the collider had carried them along in this step
    Points3 carried;
  };

  void refresh(std::size_t c, const Points3& y);
  void find_candidates(std::size_t c, SheetFeature&) const;
  void find_sides(const Points3& y);
  double inside(std::size_t c, const Points3& y);
  const Collider& collider(std::size_t c) const { return *motion_.to[c]; }  // at the end
  /// |V|x3 [m] where the collider takes the vertices from the start of the step.
  Points3 carried_by(std::size_t c) const;
  void find_swept_vertices(std::size_t c);
  Points3 taken_along() const;
  template <class Visit>
  void for_each_touch(std::size_t c, const Points3& y, Visit) const;
  template <class Visit>
  void touches_of(std::size_t c, const SheetFeature&, const Points3& y, Visit) const;
  class NearTest;
  using EdgeEnds = std::array<Vector3d, 2>;
  FeaturePair edge_pair(const Collider&, const EdgeEnds&, int k, int behind) const;
  FeaturePair corner_pair(const Collider&, const TriangleCorners&, int k, int behind) const;
  static bool is_in_front(const Collider&, const SheetFeature&, const FeaturePair&,
                          const Points3& y);
  static int corners_behind(const SheetFeature&, const std::vector<std::int8_t>& side);
  FeaturePair feature_pair(const Collider&, const SheetFeature&, int k, const Points3& y,
                           int behind) const;
  Vector3d slide(const Collider&, Vector3d from, Vector3d to, int side) const;
  Vector3d reachable(int vertex, Vector3d to) const;
  // parts of collision_free_step()
  double free_share_of_vertices(std::size_t c, const Points3& y, const Points3& motion,
                                double share) const;
  double free_share_of_feature(std::size_t c, const SheetFeature&, const Points3& y,
                               const Points3& motion, double share) const;
  template <class Visit>
  void for_each_touch(const Points3& y, Visit);  // at the end of the step
  Eigen::Vector2d trial_shear(const FrictionContact&, const Points3& y) const;
  void begin_friction(std::size_t c, const FrictionHistory&);
  void reduce_barrier_near_handles(std::size_t c, const PositionConstraints& pulled);

  std::shared_ptr<const Colliders> colliders_;
  std::vector<ColliderState> states_;
  std::vector<char> held_;
  // |V| [m] by how much closer than dhat a vertex may come without being pushed
  std::vector<double> reduction_;
  Points3 start_;
  ColliderMotion motion_;
  std::vector<FrictionContact> friction_contacts_;
};

}  // namespace paperbake
