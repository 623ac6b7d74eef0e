#pragma once

#include "core/animation/handle_constraints.h"
#include "core/animation/initial_sheet.h"
#include "core/animation/substepping.h"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace paperbake {

/// One sheet while it is animated: the phases of a frame, in this order. What is between sheets is
/// the business of sheet_islands.h.
class SheetSimulation {
 public:
  /// May the sheet go from where it is on its mesh to where it is on another, or on another branch?
  /// moved: the way [m]
  using AdmissibilityCheck =
      std::function<bool(const Sheet& here, const Sheet& there, double moved)>;

  /// number  of the sheet among those that are animated together
  /// throws  Error(Fault::scene) when options.go_on_from is no state of this shot
  SheetSimulation(const Shot&, const Method&, const AnimateOptions&, std::size_t number);

  int next_frame() const { return frame_ + 1; }

  /// The handles of the frame, and the mesh for it.
  void prepare(const AdmissibilityCheck& is_admissible);

  /// Nothing is to be done for this frame: the sheet lies still, or begins as it was modelled.
  bool is_idle() const { return is_idle_; }
  void skip_step();

  /// The elastic step by itself. Kept: there is a way back, and way() knows what the sheet passed
  enum class RecordTrajectory { yes, no };
  void step(RecordTrajectory);
  /// The elastic step of sheets that come near each other; one that has taken it by itself is taken
  /// back. reach: between them
  enum class InitialGap { within_dhat, apart };
  static void step_together(const std::vector<SheetSimulation*>&, const Eigen::MatrixXd& dhat,
                            InitialGap);
  /// Where the sheet was in this frame, from its begin.
  const std::vector<TrajectoryPoint>& trajectory() const { return trajectory_; }

  /// The step is done: what it tells of the next one.
  void finish_step(const AdmissibilityCheck& is_admissible);

  /// What is handed on. simulated_sheet: nothing of the method's is done to it
  enum class Output { finished_sheet, simulated_sheet };
  void finalize(Output);

  /// Of the frame, but for its times.
  AnimatedFrame report();

  const Sheet& sheet() const { return started_.sheet; }
  /// Where its points were as the shot began. |V|x3 [m]
  Points3 initial_positions() const;
  const Sheet& output_sheet() const { return output_sheet_; }
  const PositionConstraints& held() const { return held_; }
  const Elastic& elastic() const { return elastic_; }
  bool touches_others() const { return step_.last.touching_others > 0; }

  std::vector<double> dhat;  // [m] d^ between it and each sheet before it

 private:
  /// To the mesh that a frame began with. What touches itself may be wedged in a changed one: an
  /// edge that was turned or moved across a fold is too short, and between barriers there is no way
  /// to its length.
  struct Snapshot {
    Sheet sheet;
    SolverState state;
  };
  void archive(Serializer&);
  void restore(Snapshot&&);
  void hold_if_infeasible();
  bool is_locked() const;
  void begin_step(RecordTrajectory);
  void undo_remesh();
  SubstepTarget substep_target(RecordTrajectory);
  FrameInterval frame_interval(const Eigen::MatrixXd& dhat) const;
  void probe(const AdmissibilityCheck& is_admissible);

  const Shot& shot_;
  const Method& method_;
  AnimateOptions options_;
  std::size_t number_;
  double side_;
  InitialSheet started_;
  Elastic elastic_;
  std::optional<PlasticGrid> plastic_grid_;
  HandleConstraints constraints_;
  int min_halvings_ = 0;

  // what a frame knows of those before it
  int frame_;  // the last one that was prepared
  Sheet output_sheet_;
  Points3 positions_before_;  // [m] positions one frame ago
  PositionConstraints held_before_;
  bool at_minimum_ = false, yielding_ = false, snap_in_progress_ = false, rests_on_contact_ = false;
  int idle_frames_ = 0;
  // with itself; how many features push each other, and are pushed by colliders
  bool contact_ = false;
  int touching_ = 0, on_colliders_ = 0;
  double inside_ = 0;  // [m] a collider, of what is shown

  // of this frame
  PositionConstraints held_;
  double relative_motion_ = 0;  // [1] of the longer side
  bool is_idle_ = false, is_sleeping_ = false;
  // to the mesh before, to where the step began
  std::optional<Snapshot> before_remesh_, step_start_;
  std::vector<TrajectoryPoint> trajectory_;
  FrameStepResult step_;
  AnimatedFrame result_;
};

}  // namespace paperbake
