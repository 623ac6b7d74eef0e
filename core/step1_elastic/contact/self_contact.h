#pragma once

#include "core/geometry/swept_box_pairs.h"
#include "core/linear_algebra/block_cholesky.h"
#include "core/step1_elastic/contact/separation_bound.h"

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// Where handles hold the sheet, as far as contact has to know: what they bring together is their
/// own business.
struct HardConstraints {
  std::vector<int> vertices;
  Points3 targets;  // |vertices|x3 [m]
};

/// Two features that may touch: a vertex and a triangle it is no corner of, or two edges without a
/// common vertex.
struct ContactPair {
  std::array<int, 4> vertices;  // vertex, triangle; or edge, edge
  bool edges;
  double dhat;  // [m] d^ of this pair
};

/// Several sheets in one mesh, their vertices one after the other.
struct SheetPartition {
  std::vector<int> of_vertex;  // |V| number of its sheet
  // |sheets|x|sheets| [m] d^ between two of them, on the diagonal of one and itself
  Eigen::MatrixXd dhat;
  // |V|x3 [m] where they began, when some began on each other; else empty
  Points3 begun = {};
  // |sheets| [1] mu of each on itself; of two the geometric mean, so that none is none; empty: none
  std::vector<double> friction = {};
};

/// Contact within one mesh, of one sheet or of several: a barrier (barrier.h) for every pair of
/// features within reach.
///
/// Every pair of one sheet has its own reach d^ = min(d^ of the sheet, 0.3 x distance of the two
/// features on the pattern): neighbours do not repel each other, and a fold cannot pass through pi.
/// Of two sheets it is the d^ between them, and 0.9 x the distance that the features began with,
/// where that is known: sheets joined at a border are neighbours there. Left out are pairs held in
/// every corner; pairs that handles bring together (held vertices on both sides: d^ is 0.9 x their
/// distance at most, and nothing under 1 % of it); and, until they are apart, pairs that touch, or
/// belong to triangles that pass through each other, as a step begins. Two sides of a cut in the
/// pattern have no distance there: nothing keeps them apart.
///
/// Friction: Coulomb's, of pairs that push each other as a step begins, with their force, direction
/// and place then [Li 2020]; of pairs whose d^ is less than half of that of their sheets none. A
/// pair slides by
///
///   u = T^T (d n' - d n)  with  d n' = sum_i w_i y_i,  less what d n goes along with the turn of
///   its features
///
/// so that what moves rigidly slides nowhere, and layers that bend together do not slide by the d
/// that contact keeps between them. The turn is what the sides of the triangle, or the two edges,
/// rise along n; of edges that run alike one half of it is unknown.
class Contact {
 public:
  Contact(const Points2& pattern, const Triangles&, double friction = 0);
  Contact(const Points2& pattern, const Triangles&, SheetPartition);

  /// d^ of the sheet: 2 mm; 1 % of the side of a square of its area where that is less; the
  /// largest, of several. [m]
  double dhat() const { return dhat_; }

  /// True when nothing meets on the straight way from `from` to `to` and no pair is within reach at
  /// its end: then contact would not have changed a thing. What the triangles round a vertex do
  /// among each other is looked at only where they turn by more than 60 degrees from their mean.
  bool clear(const Points3& from, const Points3& to, const HardConstraints&);
  /// The same of features of different sheets alone.
  bool is_collision_free_between_sheets(const Points3& from, const Points3& to,
                                        const HardConstraints&);

  /// Begins a step of dt from x.
  void begin(const Points3& x, const HardConstraints&, double dt);

  /// Finds every pair that can meet or come within reach on the way from y to y + move. To be
  /// called before any function below is asked about a place on that way; it costs little while the
  /// sheet stays near the way covered last.
  void update_candidates(const Points3& y, const Points3& move);
  /// The sheet has gone the way covered last, up to here.
  void commit_step(const Points3& y);

  /// Share of the move that leaves a fifth of every gap.
  double collision_free_step(const Points3& y, const Points3& move) const;

  double energy(const Points3& y) const;  // [J]
  /// The energy; its derivative is added to the gradient, and b'' w_i w_j n n^T and that of the
  /// friction, neither ever indefinite, to the bound matrix.
  double differentiate(const Points3& y, Points3& gradient, BlockCholesky* matrix);

  /// Vertices of pairs within 1.5 d^, each with each.
  std::vector<std::pair<int, int>> coupled_vertices(const Points3& y) const;
  /// block_of[v]: block row of vertex v, -1 when it is held. Blocks that the matrix has not are
  /// passed by.
  void bind(const BlockCholesky&, const std::vector<int>& block_of);

  const std::vector<ContactPair>& pairs() const { return pairs_; }
  int active(const Points3& y) const;  // pairs within reach

  struct Active {
    int own = 0, others = 0;  // ... both features of it; one of it and one of another
  };
  std::vector<Active> active_by_sheet(const Points3& y) const;

 private:
  using Slots = std::array<BlockCholesky::Slot, 10>;  // upper half, row by row
  struct FrictionContact {                            // friction of one pair
    std::array<int, 4> vertices;
    // [1] it has slid by sum_i along_i (y_i - start_i)
    std::array<Eigen::Matrix<double, 2, 3>, 4> along;
    double force;  // [N] mu x force of the barrier
    Slots slots;
    bool placed = false;
  };

  SweptBoxPairs& near() const;
  void set_constraints(const Points3& start, const HardConstraints&);
  void find_initially_intersecting(const Points3& x);
  bool initially_intersecting(const std::array<int, 4>& vertices, bool edges) const;
  void build_candidates(const Points3& y, const Points3& move);
  void begin_friction(double dt);
  Eigen::Vector2d slip(const FrictionContact&, const Points3& y) const;  // [m] since the step began
  Slots slots_of(const std::array<int, 4>& vertices) const;
  template <class Visit>
  void for_each_pair(int a, int b, Visit) const;
  std::pair<int, int> sheets_of(const std::array<int, 4>& vertices, bool edges) const {
    return {sheets_.of_vertex[vertices[0]], sheets_.of_vertex[vertices[edges ? 2 : 1]]};
  }
  bool any_pair_collides(int a, int b, const Points3& from, const Points3& to) const;
  double dhat_of(const std::array<int, 4>& vertices, bool edges) const;
  double dhat_near_constraints(const std::array<int, 4>& vertices, bool edges, double dhat) const;
  bool pair_collides(const Points3& from, const Points3& to, const std::array<int, 4>& vertices,
                     bool edges) const;
  double drift(const Points3& y) const;
  template <class Visit>
  void for_each_active(const Points3& y, double dhat_ratio, Visit) const;

  Points2 pattern_;
  Triangles triangles_;
  std::optional<SeparationBound> separation_bound_;  // of one sheet alone
  mutable std::optional<SweptBoxPairs> near_;        // made when it is first needed
  SheetPartition sheets_;
  double dhat_;
  // [m] how far from the way covered last the list is good
  double candidate_margin_;

  std::vector<int> constraint_of_;  // |V| index into gripped_; -1
  HardConstraints gripped_;
  Points3 start_;  // [m] as the step began
  // triangles that pass through each other as the step begins
  std::vector<std::pair<int, int>> entangled_;

  std::vector<ContactPair> pairs_;
  std::vector<double> gap_bound_;  // [m] least distance on the way less reach, by pair
  Points3 reference_;              // [m] the list is good within candidate_margin_ of it
  bool swept_ = false;             // ... and of the way that begins there

  double epsilon_ = 0;  // [m] what slides less sticks
  std::vector<FrictionContact> friction_contacts_;

  const BlockCholesky* matrix_ = nullptr;
  std::vector<int> block_of_;
  std::vector<Slots> slots_;  // of pairs_, found when they are first needed
  std::vector<char> placed_;
};

}  // namespace paperbake
