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

/// When bending directions conflict, where a singular point is born, when an edge turns. Angles in
/// radians, lengths in metres.
struct CrumpleOptions {
  // [rad] turning angle |k2| sqrt(A) in the second direction that paper does not do (8 degrees)
  double conflict_turn = 0.14;
  double conflict_ratio = 0.15;  // [1]   and |k2| must be more than this share of |k1|
  // [rad] of both signs that meet in a vertex: the other way to see one (13 degrees)
  double conflict_folds = 0.23;
  // [rad] beside a singular point it takes this much: the point itself does the rest (20 degrees)
  double threshold_near_apex = 0.35;
  double fold_threshold_near_apex = 0.4;  // [rad] (23 degrees)
  // [s]   after which what lasts is no accident of the mesh ...
  double persistence_time = 15 / 24.0;
  // [s]   ... and where it is as sharp as beside a singular point
  double persistence_time_severe = 2 / 24.0;
  // [1]   between singular points, in widths of the longest ridge that the sheet can have
  double spacing = 2;
  // [1]   of the longer side: as near as a point may come to the border
  double border_share = 0.03;
  // [1]   an edge turns when the other diagonal has less than this share of its sagitta ...
  double flip_gain = 0.65;
  double flip_period = 2 / 24.0;  // [s]   ... looked at this often
  int max_points = 1000;          // [1]   on one sheet
  int max_triangles = 250;        // [1]   no point is born beyond
  RulingOptions rulings;
  SingularPointRules pins;  // where singular points may not be born
};

struct CrumpleReport {
  int flips = 0, births = 0;
  bool mesh_changed() const { return flips > 0 || births > 0; }
};

/// Step 2 of [Schreck 2015] on one mesh. The robust part: the mesh follows the bending by edge
/// flips, and where two bending directions conflict for long enough a singular point is born, at a
/// place drawn from the paper's own law. On top of it, as a proposal: a mesh whose edges are the
/// rulings of the curved regions.
class Crumple {
 public:
  /// seed, sheet  what the draws depend on, besides the number of the event
  Crumple(const Pattern&, const Paper&, const CrumpleOptions&, std::uint32_t seed,
          std::uint32_t sheet);

  /// Looks at the sheet as step 1 left it and changes its mesh for the next step. Vertices keep
  /// their numbers, new ones are appended; fixed vertices (handles and the rims of their discs)
  /// keep their place on the pattern.
  /// moving  false: the sheet is at rest, nothing is done
  CrumpleReport step(Sheet&, const std::vector<char>& fixed, const FrameTime&, bool moving);

  /// The mesh that every ruled one goes back to. To be called once, before `propose`.
  /// required  how many vertices, from number 0 on, hold what a ruled mesh must keep as it is
  void set_base_mesh(const Points2& pattern, const Triangles&, int required);

  /// Before `operate`, from a sheet at its minimum: looks for curved regions and, when the mesh
  /// does not follow their rulings, proposes one that does, with positions and velocities carried
  /// over. The required vertices keep their numbers.
  /// pulled  vertices that a lone handle moves
  /// lies    something carries the sheet: it cannot sag behind a corner that is pulled, but hooks
  ///         there
  std::optional<Sheet> propose(const Sheet&, const std::vector<int>& isolated_moving_handles,
                               bool rests_on_contact, const FrameTime&);
  /// What became of the proposal.
  void on_proposal_result(bool accepted, const FrameTime&);

  const Regions& regions() const { return regions_; }
  // of the last proposal that was accepted
  const std::vector<Ruling>& rulings() const { return rulings_; }

  void archive(Serializer&);  // all that came after set_base_mesh

 private:
  Pattern pattern_;
  Paper paper_;
  CrumpleOptions options_;
  std::uint32_t seed_, sheet_;
  struct PendingConflict {
    Vector2d p;      // [m]
    double seconds;  // how long there has been a conflict about there
  };
  std::vector<PendingConflict> pending_;
  BaseMesh base_;
  int required_ = 0;
  Regions regions_;
  std::vector<Ruling> proposed_, rulings_;
  RemeshSchedule when_;
};

}  // namespace paperbake
