#pragma once

#include "core/animation/handle_constraints.h"
#include "core/animation/initial_sheet.h"
#include "core/animation/substepping.h"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace paperbake {

/// Simulation of one sheet. The member functions are the phases of a frame, in this order. What
/// happens between sheets is in sheet_islands.h.
class Animation {
 public:
  /// Asked before the sheet is replaced by one on another mesh or on another branch: is the change
  /// admissible? moved: largest displacement [m]
  using Fits = std::function<bool(const Sheet& here, const Sheet& there, double moved)>;

  /// number  of the sheet among those that are animated together
  /// throws  Error(ErrorCode::scene) when options.resume_state is not a state of this shot
  Animation(const Shot&, const Method&, const AnimateOptions&, std::size_t number);

  int next_frame() const { return frame_ + 1; }

  /// Begins the next frame: where its handles are, and which mesh it is simulated on.
  void prepare(const Fits& fits);

  /// True if the frame needs no solve: the sheet is at rest, or it begins as it was modelled.
  bool stays() const { return stays_; }
  void stay();

  /// The elastic step of this sheet alone. With a recorded trajectory the step can be undone.
  enum class Trace { kept, none };
  void step(Trace);
  /// The elastic step of several sheets that come near each other. Sheets that have already taken
  /// it alone are first set back to where it began.
  /// dhat             |sheets|x|sheets| [m] contact distances, as in Elastic::step_together
  /// near_each_other  some of them began the shot closer to each other than their full dhat
  enum class Begun { near_each_other, apart };
  static void step_together(const std::vector<Animation*>&, const Eigen::MatrixXd& reach, Begun);
  /// Where the sheet was during this frame, from its start on.
  const std::vector<Passed>& way() const { return way_; }

  /// Ends the step: stores what the next frame has to know of it, and searches for another branch
  /// when a search is due.
  void settle(const Fits& fits);

  /// Which sheet is handed on. as_simulated: without what the method does to finish it
  enum class Shown { as_finished, as_simulated };
  void show(Shown);

  /// The frame to be handed on, without its CPU times.
  AnimatedFrame report();

  const Sheet& sheet() const { return started_.sheet; }
  /// Positions of its vertices at the start of the shot, on its present mesh. |V|x3 [m]
  Points3 begun() const;
  const Sheet& shown() const { return shown_; }
  const Held& held() const { return held_; }
  const Elastic& elastic() const { return elastic_; }
  bool touches_others() const { return step_.last.touching_others > 0; }

  std::vector<double> reach;  // [m] dhat between this sheet and each sheet before it

 private:
  /// The sheet on the mesh that a frame began with, to be restored. A sheet in contact with itself
  /// may lock after a change of mesh: an edge that was flipped or moved across a fold is too short,
  /// and the barriers around it keep it from regaining its length.
  struct WayBack {
    Sheet sheet;
    ElasticPast past;
  };
  void archive(Archive&);
  void put_on(WayBack&&);
  void wait_if_lost();
  bool wedged() const;
  void begin_step(Trace);
  void take_way_back();
  Follower follower(Trace);
  FrameToFollow way_through(const Eigen::MatrixXd& reach) const;
  void probe(const Fits& fits);

  const Shot& shot_;
  const Method& method_;
  AnimateOptions options_;
  std::size_t number_;
  double side_;
  StartedSheet started_;
  Elastic elastic_;
  std::optional<PlasticGrid> memory_;
  Grip grip_;
  int least_halvings_ = 0;

  // what a frame knows of the frames before it
  int frame_;  // the last frame that was prepared
  Sheet shown_;
  Points3 before_;  // [m] positions one frame ago
  Held held_before_;
  bool at_minimum_ = false, flowing_ = false, leaving_ = false, lies_ = false;
  int quiet_frames_ = 0;
  // contact of the sheet with itself; number of pairs of features that push each other; number of
  // features that colliders push
  bool contact_ = false;
  int touching_ = 0, on_colliders_ = 0;
  double inside_ = 0;  // [m] how deep the output sheet lies inside a collider

  // of the present frame
  Held held_;
  double leap_ = 0;  // [1] relative motion of the handles, of the longer side
  bool stays_ = false, sleeps_ = false;
  std::optional<WayBack> way_back_, begun_;  // the mesh before; the start of the step
  std::vector<Passed> way_;
  SteppedFrame step_;
  AnimatedFrame result_;
};

}  // namespace paperbake
