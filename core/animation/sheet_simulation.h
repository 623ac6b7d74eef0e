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
/// the business of sheets_beside.h.
class Animation {
 public:
  /// May the sheet go from where it is on its mesh to where it is on another, or on another branch?
  /// moved: the way [m]
  using Fits = std::function<bool(const Sheet& here, const Sheet& there, double moved)>;

  /// number  of the sheet among those that are animated together
  /// throws  Error(Fault::scene) when options.go_on_from is no state of this shot
  Animation(const Shot&, const Method&, const AnimateOptions&, std::size_t number);

  int next_frame() const { return frame_ + 1; }

  /// The handles of the frame, and the mesh for it.
  void prepare(const Fits& fits);

  /// Nothing is to be done for this frame: the sheet lies still, or begins as it was modelled.
  bool stays() const { return stays_; }
  void stay();

  /// The elastic step by itself. Kept: there is a way back, and way() knows what the sheet passed
  enum class Trace { kept, none };
  void step(Trace);
  /// The elastic step of sheets that come near each other; one that has taken it by itself is taken
  /// back. reach: between them
  enum class Begun { near_each_other, apart };
  static void step_together(const std::vector<Animation*>&, const Eigen::MatrixXd& reach, Begun);
  /// Where the sheet was in this frame, from its begin.
  const std::vector<Passed>& way() const { return way_; }

  /// The step is done: what it tells of the next one.
  void settle(const Fits& fits);

  /// What is handed on. as_simulated: nothing of the method's is done to it
  enum class Shown { as_finished, as_simulated };
  void show(Shown);

  /// Of the frame, but for its times.
  AnimatedFrame report();

  const Sheet& sheet() const { return started_.sheet; }
  /// Where its points were as the shot began. |V|x3 [m]
  Points3 begun() const;
  const Sheet& shown() const { return shown_; }
  const Held& held() const { return held_; }
  const Elastic& elastic() const { return elastic_; }
  bool touches_others() const { return step_.last.touching_others > 0; }

  std::vector<double> reach;  // [m] d^ between it and each sheet before it

 private:
  /// To the mesh that a frame began with. What touches itself may be wedged in a changed one: an
  /// edge that was turned or moved across a fold is too short, and between barriers there is no way
  /// to its length.
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

  // what a frame knows of those before it
  int frame_;  // the last one that was prepared
  Sheet shown_;
  Points3 before_;  // [m] positions one frame ago
  Held held_before_;
  bool at_minimum_ = false, flowing_ = false, leaving_ = false, lies_ = false;
  int quiet_frames_ = 0;
  // with itself; how many features push each other, and are pushed by colliders
  bool contact_ = false;
  int touching_ = 0, on_colliders_ = 0;
  double inside_ = 0;  // [m] a collider, of what is shown

  // of this frame
  Held held_;
  double leap_ = 0;  // [1] of the longer side
  bool stays_ = false, sleeps_ = false;
  std::optional<WayBack> way_back_, begun_;  // to the mesh before, to where the step began
  std::vector<Passed> way_;
  SteppedFrame step_;
  AnimatedFrame result_;
};

}  // namespace paperbake
