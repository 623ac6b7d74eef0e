#pragma once

#include "core/geometry/collider.h"
#include "core/linear_algebra/block_cholesky.h"
#include "core/step1_elastic/contact/self_contact.h"
#include "core/step1_elastic/elastic.h"

#include <array>
#include <memory>
#include <vector>

namespace paperbake {

/// What keeps paper off a collider, by the distance d from its front, and the derivatives by it.
///
///   b(d) = -kappa (d - d^)^2 ln(d/d^),  0 from d^ on, and its Taylor polynomial of degree 2 from
///   0.2 d^ down: a start that lies
///   in the collider, as sheets do that were modelled on the ground, is as good as any
///
/// kappa = 200 N/m, d^ = 0.5 mm: 0.6 N at a tenth of a millimetre, 2 N as deep inside
/// source  [Li 2020], of the distance itself; the polynomial: this project
struct ColliderBarrier {
  double value;   // [J]
  double slope;   // [N]
  double second;  // [N/m]
};
ColliderBarrier collider_barrier(double distance);
inline constexpr double collider_dhat = 5e-4;  // [m] d^

/// One mesh of a sheet against colliders: a term of the incremental potential.
///
/// What touches: a vertex of the sheet and the nearest place of a collider (more than one in a
/// corner of a room); an edge of the sheet and an edge of the collider that sticks out; a triangle
/// of the sheet and a corner that sticks out. Each has a signed distance and pushes by `pressing`.
/// Friction: Coulomb's, with force, direction and place as the step begins [Li 2020]. A vertex that
/// begins the step behind an open collider by more than its depth() has come round its border and
/// belongs there.
class ColliderContact {
 public:
  ColliderContact(std::shared_ptr<const Colliders>, const Triangles&, int vertices);

  /// Begins a step of a sheet at x. held: vertices that are not solved for. pulled: vertices that
  /// springs pull; as near to a collider as they are wanted there, it does not push them: a hand
  /// that lies on a table needs no force to stay
  void begin(const Points3& x, const ColliderMotion&, const std::vector<int>& held, double dt,
             const HardConstraints& hard = {});

  /// Takes a way from where the step began, along with colliders that move and along their surface
  /// where they are in the way. vertices, to: |vertices|x3 [m] where they were to go
  void project_outside(const std::vector<int>& vertices, Points3& to);
  void project_outside(Points3& to);  // of all vertices

  /// Share of the move after which no vertex is deeper inside than 0.2 mm and no edge or corner has
  /// come through.
  double collision_free_step(const Points3& y, const Points3& move);

  double energy(const Points3& y);  // [J]
  /// The energy; its derivative is added to the gradient, and b'' w_i w_j n n^T and that of the
  /// friction, neither ever indefinite, to the matrix. block_of[v]: block row of vertex v, -1 when
  /// it is held
  double differentiate(const Points3& y, const std::vector<int>& block_of, Points3& gradient,
                       BlockCholesky* matrix);

  int touching(const Points3& y);   // how many push
  double inside(const Points3& y);  // [m] how deep the deepest is; 0: none

 private:
  struct SheetFeature {  // a vertex, an edge or a triangle of the sheet
    std::array<int, 3> vertices;
    int corners;
    std::vector<int> near;  // of the collider: triangles, edges or corners
  };
  struct ContactPoint {
    std::array<int, 3> vertices;
    std::array<double, 3> weights;
    int corners;
    Vector3d at, normal;  // of the collider, in its own space
    double distance;
  };
  struct FeaturePair {  // of features that stick out
    std::array<double, 3> weights;
    Vector3d at, apart;  // apart: from there to the sheet
    double far;
    enum { outside, inside, nearer_to_another } where;
  };
  struct FrictionContact {  // friction of one touch
    std::array<int, 3> vertices;
    std::array<double, 3> weights;
    int corners;
    Eigen::Matrix<double, 3, 2> along;
    Vector3d carried;  // [m] how far the collider goes there in this step
    double force;      // [N] friction x pressure
  };
  struct ColliderState {  // what is known of one collider
    std::vector<SheetFeature> features;
    std::vector<int> close;  // probes that have something near
    // |V|x3 [m] in the collider's space: lists are good within tube of it; NaN: never made
    Points3 reference;
    std::vector<char> side;  // |V| -1: has come round the border of an open one
  };

  void refresh(std::size_t c, const Points3& local);
  void find_candidates(std::size_t c, SheetFeature&) const;
  Points3 to_collider_space(std::size_t c, const Points3& y, const Poses& poses) const;
  template <class Visit>
  void for_each_touch(std::size_t c, const Points3& local, Visit) const;
  template <class Visit>
  void touches_of(std::size_t c, const SheetFeature&, const Points3& local, Visit) const;
  FeaturePair feature_pair(const Collider&, const SheetFeature&, int k, const Points3& local,
                           const std::vector<char>& side) const;
  Vector3d slide(const Collider&, Vector3d from, Vector3d to, int side) const;
  template <class Visit>
  void for_each_touch(const Points3& y, Visit);  // at the end of the step
  Eigen::Vector2d slip(const FrictionContact&, const Points3& y) const;
  void begin_friction(std::size_t c, const Points3& local);
  void reduce_barrier_near_handles(std::size_t c, const HardConstraints& hard);

  std::shared_ptr<const Colliders> colliders_;
  std::vector<ColliderState> states_;
  std::vector<char> held_;
  std::vector<double> reduction_;  // |V| [m] by how much nearer than others they may be
  Points3 start_;
  ColliderMotion motion_;
  double epsilon_ = 1e-6;  // [m]
  std::vector<FrictionContact> friction_contacts_;
};

}  // namespace paperbake
