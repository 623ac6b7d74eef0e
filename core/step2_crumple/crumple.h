#pragma once

#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "core/model/singular_point_rules.h"
#include "core/step2_crumple/remesh_schedule.h"
#include "core/step2_crumple/ruled_mesh.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// When bending directions conflict, where a singular point is born and when an edge is flipped.
/// Angles in radians, lengths in metres.
struct CrumpleOptions {
  // [rad] turning angle |k2| sqrt(A) in the second principal direction above which there is a
  // conflict, because paper does not bend that way (8 degrees)
  double conflict_turn = 0.14;
  double conflict_ratio = 0.15;  // [1] besides, |k2| must be more than this fraction of |k1|
  // [rad] the other sign of a conflict: folds of both signs at one vertex, both larger than this
  // (13 degrees)
  double conflict_folds = 0.23;
  // [rad] threshold of the turning angle next to a singular point, which accounts for the rest
  // (20 degrees)
  double threshold_near_apex = 0.35;
  double fold_threshold_near_apex = 0.4;  // [rad] the same for the folds (23 degrees)
  // [s] time a conflict must persist before a singular point is born: it is then no accident of the
  // mesh
  double persistence_time = 15 / 24.0;
  // [s] the same for a severe conflict, which exceeds even the thresholds next to a singular point
  double persistence_time_severe = 2 / 24.0;
  // [1] least distance of singular points, in widths of the longest ridge that the sheet can have
  double spacing = 2;
  // [1] least distance of a singular point from the border, as a fraction of the longer side
  double border_share = 0.03;
  // [1] an edge is flipped when the other diagonal has less than this fraction of its sagitta
  double flip_gain = 0.65;
  double flip_period = 2 / 24.0;  // [s] time between two searches for edges to flip
  int max_points = 1000;          // [1] largest number of singular points on one sheet
  int max_triangles = 250;        // [1] no point is born on a mesh that would exceed this
  RulingOptions rulings;
  SingularPointRules singular_point_rules;  // where singular points must not be born
};

struct Conflicts;

/// What a step of Crumple changed: the number of edge flips and of singular points born.
struct CrumpleReport {
  int flips = 0, births = 0;
  bool mesh_changed() const { return flips > 0 || births > 0; }
};

/// Step 2 of [Schreck 2015] for one sheet. Its robust part changes the mesh that is there: edge
/// flips make it follow the bending, and where two bending directions conflict for long enough, a
/// singular point is born at a place drawn from the law of the paper. In addition it proposes new
/// meshes whose edges are the rulings of the curved regions.
class Crumple {
 public:
  /// seed, sheet  the random draws depend on these and on the number of the event alone
  Crumple(const Pattern&, const Paper&, const CrumpleOptions&, std::uint32_t seed,
          std::uint32_t sheet);

  /// Examines the sheet as step 1 left it and changes its mesh for the next step. Vertices keep
  /// their numbers and new ones are appended; fixed vertices (handles and the rims of their discs)
  /// keep their place on the pattern.
  /// moving  false: the sheet is at rest and nothing is done
  CrumpleReport step(Sheet&, const std::vector<char>& fixed, const FrameTime&, bool moving);

  /// Sets the mesh from which every ruled mesh is derived. To be called once, before `propose`.
  /// required  number of vertices, from number 0 on, that a ruled mesh must keep as they are
  void set_base_mesh(const Points2& pattern, const Triangles&, int required);

  /// To be called before `step`, with a sheet in equilibrium. Looks for curved regions and, when
  /// the mesh does not follow their rulings, proposes one that does, with positions and velocities
  /// interpolated. The required vertices keep their numbers.
  /// isolated_moving_handles  vertices that are moved by a handle with no other one near
  /// rests_on_contact         something supports the sheet: behind a corner that is pulled it
  ///                          cannot sag and bends into a hook instead
  std::optional<Sheet> propose(const Sheet&, const std::vector<int>& isolated_moving_handles,
                               bool rests_on_contact, const FrameTime&);
  /// Reports what became of the last proposal.
  void on_proposal_result(bool accepted, const FrameTime&);

  const Regions& regions() const { return regions_; }
  // of the last proposal that was accepted
  const std::vector<Ruling>& rulings() const { return rulings_; }

  void archive(Serializer&);  // everything that changes after set_base_mesh

 private:
  Pattern pattern_;
  Paper paper_;
  CrumpleOptions options_;
  std::uint32_t seed_, sheet_;
  struct PendingConflict {
    Vector2d p;      // [m]
    double seconds;  // [s] how long there has been a conflict around p
  };
  /// Updates the pending conflicts. A conflict counts once it has persisted, even across a change
  /// of mesh.
  /// returns  vertices at which it has, the worst first
  std::vector<int> due_for_birth(const Sheet&, const Conflicts&, double dt);
  /// Makes a singular point where the conflict around a vertex is, if there is room for one.
  bool give_birth(Sheet&, int worst, const Conflicts&, const std::vector<char>& fixed, int frame);

  std::vector<PendingConflict> pending_;
  BaseMesh base_;
  int required_ = 0;
  Regions regions_;
  std::vector<Ruling> proposed_, rulings_;
  RemeshSchedule when_;
};

}  // namespace paperbake
