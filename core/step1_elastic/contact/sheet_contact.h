#pragma once

#include "core/geometry/swept_box_pairs.h"
#include "core/linear_algebra/block_cholesky.h"
#include "core/step1_elastic/contact/features.h"
#include "core/step1_elastic/contact/friction_history.h"
#include "core/step1_elastic/contact/separation_bound.h"
#include "core/step1_elastic/position_constraints.h"

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// Two features that may collide: a vertex and a triangle that it is no corner of, or two edges
/// without a common vertex.
struct ContactPair {
  std::array<int, 4> vertices;  // the corners of both
  Features features;
  double dhat;  // [m] dhat of this pair
};

/// Several sheets in one mesh, with their vertices one after the other.
struct SheetPartition {
  std::vector<int> of_vertex;  // |V| index of the sheet
  // |sheets|x|sheets| [m] dhat between two sheets; on the diagonal that of a sheet and itself
  Eigen::MatrixXd dhat;
  // |V|x3 [m] initial positions, if some sheets began on each other; else empty
  Points3 initial_positions = {};
  // |sheets| [1] friction coefficient of each on itself; for two sheets the geometric mean, so zero
  // friction on either gives zero; empty: frictionless
  std::vector<double> friction = {};
  // |sheets| number of each in the shot and its first vertex in the mesh, for FrictionHistory
  std::vector<int> number = {0}, first = {0};
};

/// Contact within one mesh, of one sheet or of several: a barrier (barrier.h) between every pair of
/// features closer than dhat.
///
/// Every pair of features of one sheet has its own dhat = min(dhat of the sheet, 0.3 x distance of
/// the two features on the pattern): neighbours do not repel each other, and a dihedral angle
/// cannot pass through pi. For features of two sheets it is the dhat between these, and at most 0.9
/// x the initial distance of the features where that is known: sheets joined at a border are
/// neighbours there.
///
/// Left out are
/// - pairs whose corners are all constrained;
/// - pairs that handles bring together: where there are constrained vertices on both sides, dhat is
///   at most 0.9 x their distance, and the pair is ignored if that is under 1 % of its dhat;
/// - until they have separated, pairs that touch at the beginning of a step, or that belong to
///   triangles that intersect each other then.
/// The two sides of a cut in the pattern have no distance there: nothing keeps them apart.
///
/// Friction is Coulomb's, for pairs that push each other at the beginning of a step, with the
/// forces, directions and contact points of that time [Li 2020]; a pair remembers its shear from
/// step to step (friction_history.h). Pairs whose dhat is less than half of that of their sheets
/// have no friction. A pair slides by
///
///   u = T^T (d n' - d n)   with  d n' = sum_i w_i y_i,
///
/// where n is its normal at the beginning of the step, T two tangents across n, w_i the weights
/// of the closest points then, and y_i its corners now, so that d n' is the vector between these
/// points now; less the part of it by which d n only rotates with its features. So there is no
/// sliding in a rigid motion, and layers that bend together do not slide because of the distance d
/// that contact keeps between them. The rotation is found from how far the sides of the triangle,
/// or the two edges, rise along n; where two edges are nearly parallel, one of its two components
/// is unknown and left out.
class SheetContact {
 public:
  /// number  of the sheet in the shot
  SheetContact(const Points2& pattern, const Triangles&, double friction = 0, int number = 0);
  SheetContact(const Points2& pattern, const Triangles&, SheetPartition);

  /// [m] dhat of the sheet: 0.5 mm, or 1 % of the side of a square of the same area if that is
  /// less; the largest one of several sheets.
  double dhat() const { return dhat_; }

  /// True if nothing collides on the straight motion from `from` to `to` and no pair is closer than
  /// dhat at its end: contact would then have changed nothing. The triangles around one vertex are
  /// checked against each other only where one deviates by 60 degrees or more from their mean
  /// normal.
  bool is_collision_free(const Points3& from, const Points3& to, const PositionConstraints& hard);
  /// The same for pairs of features of different sheets only.
  bool is_collision_free_between_sheets(const Points3& from, const Points3& to,
                                        const PositionConstraints& hard);

  /// Lets features of a folded sheet come as near to each other as its panels do where hands hold
  /// these flat: there dhat is at most 0.9 x that distance, but not less than `least`.
  /// panels  |V|x3 [m] positions of the vertices in flat panels; empty: none are held
  /// least   [m] the thickness of the paper
  void set_panels(Points3 panels, double least) {
    panels_ = std::move(panels);
    least_between_panels_ = least;
  }

  /// Begins a step at x.
  /// hard     pairs of features that these constraints bring together are excluded from contact
  /// history  what pairs remember of the step before
  void begin(const Points3& x, const PositionConstraints& hard,
             const FrictionHistory& history = {});
  /// Writes the shear of every pair with friction at the end of the step.
  void remember(const Points3& y, FrictionHistory&) const;

  /// Finds every pair that can collide or come closer than dhat on the motion from y to y + move.
  /// To be called before any function below is asked about positions on that motion; it costs
  /// little while the sheet stays near the motion of the last update.
  void update_candidates(const Points3& y, const Points3& move);
  /// The sheet has moved to y, as announced by the last update_candidates.
  void commit_step(const Points3& y);

  /// Fraction of the move that leaves at least a fifth of every gap.
  double collision_free_step(const Points3& y, const Points3& move) const;

  double energy(const Points3& y) const;  // [J]
  /// Returns the energy [J]. Adds its gradient [N] to `gradient`, and to the bound matrix the
  /// Hessians b'' w_i w_j n n^T of the barrier and that of friction [N/m], neither of which is ever
  /// indefinite.
  double differentiate(const Points3& y, Points3& gradient, BlockCholesky* matrix);

  /// All pairs of vertices within a contact pair whose features are closer than 1.5 dhat.
  std::vector<std::pair<int, int>> coupled_vertices(const Points3& y) const;
  /// Remembers where the blocks of the matrix lie; blocks that it does not have are ignored.
  /// block_of  |V| block row of each vertex, -1: constrained
  void bind(const BlockCholesky&, const std::vector<int>& block_of);

  const std::vector<ContactPair>& pairs() const { return pairs_; }
  int touching(const Points3& y) const;  // number of pairs closer than dhat

  struct Touching {
    int own = 0, others = 0;  // pairs with both features on the sheet; with one on another
  };
  std::vector<Touching> touching_by_sheet(const Points3& y) const;

 private:
  using Slots = std::array<BlockCholesky::Slot, 10>;  // upper half, row by row
  struct FrictionContact {                            // friction of one pair
    std::array<int, 4> vertices;
    // [1] the pair has slid by sum_i along_i (y_i - start_i)
    std::array<Eigen::Matrix<double, 2, 3>, 4> along;
    double force;  // [N] friction coefficient x force of the barrier
    // from there to space, or to the other side where the name has the features the other way round
    Eigen::Matrix<double, 3, 2> to_history;
    TouchingFeatures name;
    Eigen::Vector2d shear;  // [m] at the beginning of the step
    Slots slots = {};
    bool placed = false;
  };

  SweptBoxPairs& near();
  void set_constraints(const Points3& start, const PositionConstraints& hard);
  void find_initially_intersecting(const Points3& x);
  bool initially_intersecting(const std::array<int, 4>& vertices, Features) const;
  void build_candidates(const Points3& y, const Points3& move);
  void begin_friction(const FrictionHistory&);
  /// swapped  receives whether the name has the two edges the other way round
  TouchingFeatures name_of(const ContactPair&, bool& swapped) const;
  Eigen::Vector2d trial_shear(const FrictionContact&, const Points3& y) const;
  Slots slots_of(const std::array<int, 4>& vertices) const;
  template <class Visit>
  void for_each_pair(int a, int b, Visit);
  std::pair<int, int> sheets_of(const std::array<int, 4>& vertices, Features features) const {
    return {sheets_.of_vertex[vertices[0]], sheets_.of_vertex[vertices[second_of(features)]]};
  }
  bool any_pair_collides(int a, int b, const Points3& from, const Points3& to);
  double dhat_of(const std::array<int, 4>& vertices, Features) const;
  double dhat_near_constraints(const std::array<int, 4>& vertices, Features, double dhat) const;
  bool pair_collides(const Points3& from, const Points3& to, const std::array<int, 4>& vertices,
                     Features) const;
  double drift(const Points3& y) const;
  template <class Visit>
  void for_each_active(const Points3& y, double dhat_ratio, Visit) const;

  Points2 pattern_;
  Triangles triangles_;
  std::optional<SeparationBound> separation_bound_;  // for a single sheet only
  std::optional<SweptBoxPairs> near_;                // made when it is first needed
  SheetPartition sheets_;
  double dhat_;
  // [m] how far vertices may be off the motion of the last update before the list is rebuilt
  double candidate_margin_;

  Points3 panels_;                   // [m] as in set_panels
  double least_between_panels_ = 0;  // [m]

  std::vector<int> constraint_of_;  // |V| index into hard_; -1: free
  PositionConstraints hard_;
  Points3 start_;  // [m] positions at the beginning of the step
  // triangles that intersect each other at the beginning of the step
  std::vector<std::pair<int, int>> entangled_;

  std::vector<ContactPair> pairs_;
  std::vector<double> gap_bound_;  // [m] least distance during the motion, less dhat, of each pair
  Points3 reference_;              // [m] the list is valid within candidate_margin_ of these
  bool swept_ = false;             // ... and of the motion that begins there

  std::vector<FrictionContact> friction_contacts_;

  const BlockCholesky* matrix_ = nullptr;
  std::vector<int> block_of_;
  std::vector<Slots> slots_;  // of pairs_, found when they are first needed
  std::vector<char> placed_;
};

}  // namespace paperbake
