#pragma once

#include "baker/bake/stage_clock.h"
#include "baker/bake/stop_request.h"
#include "baker/job/plan.h"
#include "core/animation/animate.h"

#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// Where a candidate keeps the frames that it simulates, and whether those that it finds there are
/// its own.
struct CandidateFolder {
  std::filesystem::path path;
  bool goes_on = false;  // from the checkpoints in it
  int checkpoint_every = 12;
};

/// How attempts are compared.
struct Comparison {
  AttemptReason reason;  // why they are
  int points;  // with so many singular points, born in a sheet, one is no better than the first
  // [m] nor is one whose sheet is pulled off a handle by more (Attempt::pulled)
  double pulled;
};

/// What attempts are compared by: how often they miss a gate (worst_miss); all that miss none have
/// 1. Where handles are not the reason, those are infinitely bad that miss one, are pulled off
/// their handles or have too many singular points; one that is over, but has singular points or
/// coarse triangles, is worse than one without, and the less so the finer it is.
/// is_over  whether all of its frames are known
double badness(const Attempt&, bool is_over, const Comparison&);

/// An attempt that is being simulated. It may be simulated ahead of what is known() of it, on
/// another thread. Only what show_frame() has shown counts, so that a choice among candidates does
/// not depend on the number of threads.
class Candidate {
 public:
  /// plan    of the attempt
  /// known   of it before: of its first known.frames frames
  Candidate(BakePlan plan, const Attempt& known, Comparison, CandidateFolder, StopRequest&,
            StageClock&);
  ~Candidate();

  const Attempt& known() const { return shown_.attempt; }
  /// Whether it has shown a frame.
  bool has_begun() const { return begun_; }
  bool is_over() const { return is_over(shown_); }
  bool is_hopeless() const { return is_hopeless(shown_); }
  bool has_failed() const { return shown_.failed; }  // it could not be simulated
  double badness() const { return badness(shown_); }
  /// A sentence for people on how far it is.
  std::string describe_state(std::size_t number, std::size_t of) const;

  bool is_busy() const { return task_.valid(); }
  /// Whether the next frame to be shown is simulated.
  bool has_frame() const { return !not_shown_.empty(); }
  /// Whether there is a reason to simulate another frame: it is not over or hopeless as far as it
  /// is simulated. To be asked while it is not busy.
  bool can_go_on() const { return !is_over(ahead_) && !is_hopeless(ahead_); }
  /// badness() as far as it is simulated, a frame that is being simulated not counted.
  double badness_ahead() const { return badness(ahead_); }
  /// Starts to simulate the next frame. To be called while it is not busy.
  /// on  std::launch::deferred: show_frame() simulates it
  void start(std::launch on);
  /// Takes in what was simulated since it was started, if that is done.
  void look();
  /// Makes the next frame known: waits for it where it is not simulated yet. Shows none when the
  /// bake is stopped.
  void show_frame();

 private:
  /// What is known after a frame.
  struct State {
    Attempt attempt;
    bool failed = false;
  };
  bool is_over(const State&) const;
  bool is_hopeless(const State&) const;
  double badness(const State&) const;

  /// What simulates the frames, and knows the last one.
  class Simulation;
  /// What a task hands back. While it is busy, it alone has the simulation.
  struct Simulated {
    std::unique_ptr<Simulation> simulation;
    std::vector<State> states;  // after each frame that was not known before
  };
  void take_in();

  const BakePlan plan_;
  Comparison by_;
  State shown_, ahead_;
  std::deque<State> not_shown_;  // after each frame from the one after shown_ to ahead_
  bool begun_ = false;
  std::unique_ptr<Simulation> simulation_;  // null: the task has it
  std::future<Simulated> task_;             // the last member: it ends before the others do
};

/// How far a handle may be off before other attempts are tried: as far as the bake lets it be. [m]
double tolerance_of_attempts();

/// How many times as far as a gate allows its handles are off, or its paper is inside a collider,
/// whichever is more. [1] at most 1: it misses neither of both gates
double worst_miss(const Attempt&);

/// Adds a frame of an attempt to what is known of it: its handles and those of other sheets in it,
/// the singular points that were born in its sheet, and how deep it gets into a collider.
/// Distances that paper cannot bridge (BakePlan::impossible, Overshoot) do not count, nor frames in
/// which the sheet is pulled off its handles (baker/output/gates.h), but to say how far: no attempt
/// makes a hand stronger.
void add_frame(Attempt&, const AnimatedFrame&, const BakePlan&);

}  // namespace paperbake
