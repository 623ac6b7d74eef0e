#pragma once

#include "core/animation/simulated_sheet.h"
#include "core/animation/substepping.h"
#include "core/animation/swing.h"
#include "core/model/serializer.h"

#include <functional>
#include <optional>
#include <string>

namespace paperbake {

/// Decides when a sheet that is simulated without inertia gets it: from the frame in which handles
/// let go of it and it springs, or in which it loses its balance and its weight takes it elsewhere,
/// until it has come to rest (ReleaseInertia). A sheet that was modelled in a shape which does not
/// bear its weight is let go, too, after the first frame, which shows it as it was modelled; but
/// nobody means it to swing, so its motion is damped critically, until it is at rest or handles let
/// go of it. A frame in which that may begin or end is first taken without inertia, on trial.
class ReleaseTrial {
 public:
  /// gravity  [m/s2]
  ReleaseTrial(double fps, double gravity) : fps_(fps), gravity_(gravity) {}

  /// Begins a trial if there is reason for one. To be called before the mesh of the frame is
  /// changed, which may change what the sheet stores.
  enum class LetGo { no, by_handles, as_modelled, by_balance };
  /// by_handles   a vertex that was held in the frame before no longer is
  /// as_modelled  this is the second frame of a sheet that has weight
  /// by_balance   this is another frame of one, which may lose its balance
  void begin(SimulatedSheet&, LetGo);
  void skip() { is_on_ = false; }
  bool is_on() const { return is_on_; }

  /// [m/s] of the fastest handle or collider, so many frames ago
  using FastestDrive = std::function<double(int)>;
  struct Verdict {
    bool needs_inertia = false;  // the sheet has it now; the step is to be taken again from `start`
    std::string note;            // for the artist; may be empty
  };
  /// Ends the trial after the step of the frame.
  /// start          where the step began. A sheet that was at equilibrium gets no more velocity
  ///                there than the fastest drive of the frame before.
  /// at             the input of this frame, with the colliders standing still
  Verdict end(SimulatedSheet&, Snapshot& start, const FrameStepResult&, const StepInput& at,
              const FastestDrive&);

  /// Gives the sheet the inertia that it has because it was let go.
  void give_inertia(SimulatedSheet&) const;
  /// Whether the sheet has inertia because it was let go.
  bool was_let_go() const { return swing_.rate > 0; }
  /// To be called after every frame of such a sheet.
  /// fastest_drive  [m/s] in this frame
  void observe(SimulatedSheet&, const StepInput& at, double fastest_drive);

  void archive(Serializer&);

 private:
  Swing swing(SimulatedSheet&, const Snapshot& start, const FrameStepResult&,
              const StepInput& at) const;
  /// The potential [J] at the start of the step on trial, if it moves the sheet farther than it can
  /// fall in a frame, and its weight frees more energy in that than the paper does.
  std::optional<double> potential_before_drop(SimulatedSheet&, const Snapshot& start,
                                              const FrameStepResult&, const FastestDrive&) const;
  std::string note_of(const Swing&) const;

  double fps_, gravity_;
  bool is_on_ = false;
  LetGo let_go_ = LetGo::no;       // of the trial
  double potential_at_start_ = 0;  // [J] of the sheet that is let go, on trial
  Swing swing_;  // since handles let go of the sheet; rate 0: it has no inertia because of that
  double damping_ = 0;  // [1/s] as in ElasticOptions
  double quiet_ = 0;    // [s] for how long it has swung no more than what is still
};

}  // namespace paperbake
