#pragma once

#include "core/animation/carried_sheet.h"
#include "core/animation/collider_jam.h"
#include "core/animation/fold_search.h"
#include "core/animation/handle_constraints.h"
#include "core/animation/mesh_check.h"
#include "core/animation/mesh_swap.h"
#include "core/animation/rehearsal.h"
#include "core/animation/release_trial.h"
#include "core/animation/simulated_sheet.h"
#include "core/animation/substepping.h"

#include <memory>
#include <optional>
#include <vector>

namespace paperbake {

/// Simulates one sheet frame by frame. For each frame call prepare(); then step(), or
/// step_together() for sheets that come near each other; finish_step(); finalize(); report(). What
/// happens between sheets is in sheet_islands.h.
class SheetSimulation {
 public:
  /// A sheet among those that are animated together.
  struct Place {
    std::size_t number;
    Rehearsal rehearsal;
  };
  /// throws  Error(ErrorCode::scene) when options.resume_state is not a state of this shot
  SheetSimulation(const Shot&, const MethodChoice&, const AnimateOptions&, const Place&);

  int next_frame() const { return frame_ + 1; }

  /// Whether the sheet would behave in another way on a finer first mesh, and there is one.
  bool may_start_finer() const;
  /// Whether the sheet is one that a rehearsal tells something about: smooth, without inertia,
  /// among colliders.
  bool is_rehearsed() const;
  /// How often the number of triangles of its first mesh was doubled.
  int doublings() const { return method_->doublings(); }
  /// Whether the sheet lies on a collider on triangles that turn so far from one to the next that
  /// they hold it back for certain.
  bool rests_on_coarse_folds() const;
  /// Whether the smooth sheet stores as much by stretching as only a crumpled one does, or twice as
  /// much already where its bends begin: its mesh is too coarse for them.
  bool stretches_instead_of_bending() const;
  /// Relative motion of the handles in the present frame. [1] of the longer side
  double relative_motion() const { return now_.relative_motion; }

  /// Begins the next frame: where its handles are, and which mesh it is simulated on.
  void prepare(const AdmissibilityCheck& is_admissible);

  /// True if the frame needs no solve: the sheet is at rest, or it begins as it was modelled.
  bool is_idle() const { return now_.is_idle; }

  /// The elastic step of this sheet alone; one that is idle stays where it is. With a recorded
  /// trajectory the step can be undone.
  enum class RecordTrajectory { yes, no };
  void step(RecordTrajectory, const AdmissibilityCheck& is_admissible);
  /// Whether some of several sheets began the shot closer to each other than their full dhat.
  enum class InitialGap { within_dhat, apart };
  using AdmissibilityOfSheet = std::function<AdmissibilityCheck(std::size_t)>;  // by its number
  /// The elastic step of several sheets that come near each other. Sheets that have already taken
  /// it alone are first set back to where it began.
  /// dhat  |sheets|x|sheets| [m] contact distances, as in Elastic::step_together
  static void step_together(const std::vector<SheetSimulation*>&, const Eigen::MatrixXd& dhat,
                            InitialGap, const AdmissibilityOfSheet& is_admissible);
  /// Where the sheet was during this frame, from its start on.
  const std::vector<TrajectoryPoint>& trajectory() const { return now_.trajectory.points(); }

  /// Ends the step: stores what the next frame has to know of it, and searches for another branch
  /// when a search is due.
  void finish_step(const AdmissibilityCheck& is_admissible);

  /// Which sheet is handed on. simulated_sheet: without what the method does to finish it
  enum class Output { finished_sheet, simulated_sheet };
  void finalize(Output);

  /// The last frame whose keys the simulation has seen, here or in a rehearsal.
  int keys_until() const;

  /// The frame to be handed on, without its CPU times.
  AnimatedFrame report();

  const Sheet& sheet() const { return simulated_.sheet; }
  /// Positions of its vertices at the start of the shot, on its present mesh. |V|x3 [m]
  Points3 initial_positions() const { return simulated_.initial_positions(); }
  const Sheet& output_sheet() const { return output_sheet_; }
  const PositionConstraints& constraints() const { return now_.input.constraints; }
  const Elastic& elastic() const { return simulated_.elastic; }
  bool touches_others() const { return now_.step.last.touching_others > 0; }

  std::vector<double> dhat;  // [m] dhat between this sheet and each sheet before it

 private:
  class IslandStep;  // island_step.h

  /// What a step leaves behind for the next one.
  struct StepOutcome {
    bool at_minimum = false;  // it converged, and not into a snap
    bool snap_in_progress = false;
    bool contact = false;           // of the sheet with itself
    bool rests_on_contact = false;  // with a collider or another sheet
    bool yielded = false;           // the paper, somewhere
    int touching = 0;               // number of pairs of features of the sheet that push each other
    int on_colliders = 0;           // number of features that colliders push
    void archive(Serializer& a) {
      a(at_minimum, snap_in_progress, contact, rests_on_contact, yielded, touching, on_colliders);
    }
  };
  /// The last change of mesh, as long as it can be undone.
  struct LastRemesh {
    SimulatedSheet::MeshSnapshot before;
    bool was_at_minimum;  // the sheet, before it
    bool vertices_moved;  // on the pattern
  };
  /// What a frame begins with that is taken in more than one step.
  struct FrameStart {
    std::string state;  // as in AnimateOptions::resume_state
    Inertia inertia;
    ReleaseTrial release;
    AnimatedFrame result;
  };

  /// What is known of the present frame alone.
  struct PresentFrame {
    StepInput input;
    double followed = 0;  // [1] of the frame, as far as the sheet has followed its colliders
    // the targets of the frame before, from which the handles come
    PositionConstraints came_from;
    double relative_motion = 0;  // [1] relative motion of the handles, of the longer side
    double squeeze = 0;          // [1] how far colliders squeeze the sheet, of the longer side
    double max_motion = 0;       // [m] of a handle, a collider or a vertex (motion_measures.h)
    int load_parts = 1;          // number of parts in which the step is taken
    std::size_t singular_before = 0;
    bool is_idle = false, is_sleeping = false;
    std::optional<LastRemesh> last_remesh;  // none that could be undone
    std::optional<Snapshot> step_start;     // none that can be gone back to
    std::optional<FrameStart> frame_start;  // none: step_start is where it began
    Trajectory trajectory;
    std::vector<TrajectoryPoint> path_of_step;  // that is being taken
    FrameStepResult step;
    AnimatedFrame result;
  };

  void archive(Serializer&);
  /// Where handles, hands and colliders are in the present frame.
  void move_world();
  void restore(const SimulatedSheet::MeshSnapshot&);
  /// Leaves the sheet where it is.
  void skip_step();
  /// What the method is told before part of a frame. share: [1] of the frame
  RemeshContext remesh_context(double share);
  /// Lets the method propose another mesh, and takes it if the sheet stays the same on it.
  void try_proposal(const RemeshContext&, const AdmissibilityCheck& is_admissible);
  /// Folds the sheet along a line that nobody announced, if there is one. To be called after a step
  /// or a part of one.
  void fold_if_bent(const AdmissibilityCheck& is_admissible);
  /// Into how many parts the frame is divided.
  int parts_of_frame() const;
  /// How often each of these parts is halved, so that no step with inertia is too long.
  int halvings_of_part() const;
  /// Keeps a step that is about to be taken for folds_.
  void remember(int part);
  /// Lets the method change the mesh, unless the sheet comes nearer to others or cuts into a
  /// collider by that.
  /// returns  whether the mesh is another one now; now_.last_remesh then keeps the one before
  bool change_mesh(const RemeshContext&, const AdmissibilityCheck& is_admissible);
  /// Whether the change of mesh has put an edge or a triangle into a collider, deeper than before:
  /// it would be stuck there.
  bool cuts_into_collider(const Sheet& before) const;
  /// The input of a part of the frame. part: 1 to now_.load_parts
  StepInput input_of_part(int part) const;
  /// Begins a trial of this frame without inertia, if there is reason for one (release_trial.h).
  void begin_trial();
  /// Ends it, with inertia if it has failed. returns  whether the step is to be taken again, from
  /// now_.step_start
  bool end_trial();
  /// [m/s] of the fastest handle or collider in a frame
  double fastest_drive(int frame) const;
  /// Sets the sheet back to now_.step_start, if there is one.
  void roll_back();
  void add_note(const std::string&);
  /// Holds a sheet that cannot follow its handles where it is, until they are where it can. A jam
  /// lasts meanwhile.
  /// returns  whether it is held
  bool hold_if_infeasible();
  /// Whether the last change of mesh is why the sheet did not get through its contacts with itself.
  bool is_locked() const;
  void begin_step(RecordTrajectory);
  /// Whether the sheet may change its mesh within the frame if it takes it alone.
  bool may_step_in_parts() const;
  /// Keeps what undo_step() needs.
  void keep_frame_start();
  /// Sets the sheet back to where the frame began, to take it together with others.
  void undo_step();
  void undo_remesh();
  /// Ends the step of a sheet that could not follow, too.
  void end_step();
  /// The sheet with what drives it through the whole frame, or through a part of it.
  DrivenSheet driven_sheet(RecordTrajectory);
  DrivenSheet driven_in_part(RecordTrajectory, int part);
  /// Ends a part of the frame. before: the step of the parts before it, or of the same part before
  /// it was tried again
  void end_part(FrameStepResult before, int part);
  /// Whether the sheet has not moved for so long that it need not be solved until something else
  /// does.
  bool comes_to_rest() const;
  /// Whether the sheet gets a finer mesh if colliders bend it more sharply than its own one can.
  bool may_refine() const;
  /// Takes a finer mesh for a sheet that is jammed, if its mesh could not fold.
  /// returns  false if there is none
  bool refine_where_jammed(const AdmissibilityCheck& is_admissible);
  bool refine_jammed_smooth_mesh(const AdmissibilityCheck& is_admissible);
  /// Leaves a jammed sheet behind where the colliders were when it last followed them.
  void hold_if_jammed();
  /// Whether colliders bend the smooth sheet so sharply that its triangles hook on each other, or
  /// that it stretches instead of bending.
  bool is_held_back_by_mesh() const;
  /// Goes back to the start of the step, on a finer mesh. Where its edges cut into a collider,
  /// because those of the mesh before it went round the collider elsewhere, it is pushed out.
  /// returns  false if there is no finer mesh, or if it cannot be pushed out: the step stays
  bool go_back_on_finer_mesh(const SimulatedSheet::MeshSnapshot& start, const AdmissibilityCheck&);
  /// Pushes the sheet out of the colliders where they are as the step begins.
  /// returns  whether it is outside, and does not pass through anything else
  bool leave_colliders(const AdmissibilityCheck&);
  /// Goes back to the start of the step, on a finer mesh. returns  false if there is none; the
  /// meshes of a shot that has begun get no more than doublings_to_bend
  /// doublings  of the number of triangles, at most
  bool refine_mesh(const SimulatedSheet::MeshSnapshot& start, int doublings);
  FrameInterval frame_interval(const Eigen::MatrixXd& dhat_of_sheets) const;
  /// Keeps what the last step says of contact, yielding and its end.
  void note_outcome();
  /// Finds out how far its mesh puts the sheet off (mesh_check.h).
  void check_mesh();
  /// Searches for a lower branch (branch_search.h), and takes it if it is admissible.
  void probe(const AdmissibilityCheck& is_admissible);

  const Shot& shot_;
  std::unique_ptr<Method> method_;
  AnimateOptions options_;
  std::size_t number_;
  int rehearsed_doublings_;    // of the triangles of its first mesh
  bool lacks_triangles_;       // as in Rehearsal
  int keys_until_;             // the last frame whose keys a rehearsal has seen
  int inertial_halvings_ = 0;  // of a frame with inertia, at least
  SimulatedSheet simulated_;
  HandleConstraints handles_;
  ReleaseTrial release_;
  FoldSearch folds_;
  CarriedSheet carried_;
  MeshCheck mesh_check_;

  // what a frame knows of the frames before it
  int frame_;  // the last frame that was prepared
  Sheet output_sheet_;
  // holds the sheet where a frame ends, with the colliders standing still: the frame before, until
  // prepare() has come to the mesh, then the present one
  StepInput resting_input_;
  StepOutcome outcome_;
  bool yielding_ = false;  // the paper, by a notable part of its folds, in the last frame
  bool folded_ = false;    // the sheet, along a line that was found in the last step
  bool joined_ = false;    // the sheet has taken the last step together with others
  int idle_frames_ = 0;
  double inside_ = 0;  // [m] how deep the output sheet lies inside a collider
  ColliderJam jam_;

  PresentFrame now_;
};

}  // namespace paperbake
