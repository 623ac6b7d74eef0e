#include "baker/bake/candidate.h"

#include "baker/bake/bend_watch.h"
#include "baker/output/checkpoints.h"
#include "baker/output/gates.h"
#include "core/hands/handle_feasibility.h"
#include "core/model/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <utility>

namespace paperbake {
namespace {

/// By how much the paper between a handle and another one is too short: a handle may be off by so
/// much whatever the attempt. [m]
double unavoidable(const BakePlan& plan, const AnimatedFrame& frame, std::size_t handle) {
  const Shot& shot = plan.shots[frame.sheet_index];
  const std::string& name = shot.handles[handle].name;
  double most = 0;
  if (frame.handles[handle].state == HandleFrame::jammed)
    most = overshoot(shot.pattern, shot.handles, frame.handles, static_cast<int>(handle)).length;
  for (const UnreachablePairOfSheet& i : plan.impossible)
    if (i.sheet == shot.sheet_name && (i.pair.a == name || i.pair.b == name))
      most = std::max(most, i.pair.apart - i.pair.allowed);
  return most;
}

int frames_of(const BakePlan& plan) {
  return plan.animation.last_frame - plan.animation.first_frame + 1;
}

}  // namespace

double tolerance_of_attempts() { return 1e-3 * Gates{}.handle_err_mm; }

double worst_miss(const Attempt& attempt) {
  return std::max(1e3 * attempt.off / Gates{}.handle_err_mm,
                  1e3 * attempt.inside / Gates{}.inside_mm);
}

double badness(const Attempt& attempt, bool is_over, const Comparison& by) {
  const double miss = worst_miss(attempt);
  if (by.reason == AttemptReason::handle_off) return std::max(1.0, miss);
  if (attempt.points >= by.points || miss > 1 || attempt.pulled > by.pulled)
    return std::numeric_limits<double>::infinity();
  const bool is_doubted = is_over && (attempt.coarse || attempt.points > 0);
  return is_doubted ? 1 + 1.0 / attempt.base_triangles : 1;
}

void add_frame(Attempt& attempt, const AnimatedFrame& frame, const BakePlan& plan) {
  const Shot& shot = plan.shots[frame.sheet_index];
  const double side = longer_side(shot.pattern);
  const auto born = std::count_if(
      frame.sheet->singular.begin(), frame.sheet->singular.end(),
      [&](const SingularPoint& p) { return p.frame_of_birth > plan.animation.first_frame; });
  attempt.points = std::max(attempt.points, static_cast<int>(born));
  if (frame.frame > plan.animation.first_frame)  // where it begins is the same in all
    attempt.inside = std::max(attempt.inside, frame.statistics.inside_colliders);
  const auto held =
      std::count_if(frame.handles.begin(), frame.handles.end(),
                    [](const HandleFrame& handle) { return handle.state != HandleFrame::free; });
  const auto points = static_cast<int>(frame.sheet->singular.size());
  const bool pulled = is_pulled(frame.statistics, points, static_cast<int>(held));
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const double off = frame.handles[h].error() - unavoidable(plan, frame, h);
    if (pulled) {
      attempt.pulled = std::max(attempt.pulled, off);
      continue;
    }
    attempt.off_pct = std::max(attempt.off_pct, 100 * off / side);
    if (off <= attempt.off) continue;
    attempt.off = off;
    attempt.frame = frame.frame;
  }
}

class Candidate::Simulation {
 public:
  Simulation(const BakePlan&, const Attempt& known, CandidateFolder, StopRequest&, StageClock&);

  /// Simulates the next frame; the first time only if the folder has none that was not known.
  /// returns  what is known after each frame that was not known before; empty: it was stopped
  std::vector<State> next_frame();

 private:
  void begin(std::vector<State>&);
  void add(const AnimatedFrame&, std::vector<State>&);

  const BakePlan& plan_;  // which nobody changes while a task reads it
  CandidateFolder folder_;
  StageClock& clock_;
  std::vector<AnimateOptions> options_;
  State now_;
  int frames_ = 0;                // simulated
  std::vector<BendWatch> bends_;  // of its sheets
  std::optional<Checkpoints> checkpoints_;
  std::optional<Animation> animation_;
};

Candidate::Simulation::Simulation(const BakePlan& plan, const Attempt& known,
                                  CandidateFolder folder, StopRequest& stop, StageClock& clock)
    : plan_(plan),
      folder_(std::move(folder)),
      clock_(clock),
      options_(options_of_sheets(plan_)),
      now_{known},
      bends_(plan.shots.size()) {
  for (AnimateOptions& of_sheet : options_) {
    of_sheet.report_plastic_curvature = true;  // who takes its frames may want maps
    of_sheet.asks_to_stop = [&stop] { return stop.is_made(); };
  }
}

std::vector<Candidate::State> Candidate::Simulation::next_frame() {
  const StageClock::Part part(&clock_, Stage::attempts);
  std::vector<State> states;
  try {
    if (!checkpoints_) begin(states);
    if (states.empty())
      for (const AnimatedFrame& frame : animation_->next_frame()) {
        checkpoints_->add(frame);
        add(frame, states);
      }
  } catch (const Error& error) {
    // whoever stops it knows; anything else the bake itself says, if no attempt is better
    now_.failed = error.code != ErrorCode::stopped;
    if (now_.failed) states.push_back(now_);
  }
  return states;
}

void Candidate::Simulation::begin(std::vector<State>& states) {
  checkpoints_.emplace(folder_.path, plan_, folder_.checkpoint_every);
  int last = plan_.animation.first_frame - 1;
  if (folder_.goes_on) {
    Checkpoints::ResumePoint resume = checkpoints_->load([&](const AnimatedFrame& frame) {
      add(frame, states);
      return true;
    });
    last = resume.last_frame;
    for (std::size_t s = 0; s < resume.states.size(); ++s)
      options_[s].resume_state = std::move(resume.states[s]);
  }
  if (last == plan_.animation.last_frame) return;
  std::vector<AnimatedSheet> sheets;
  for (std::size_t s = 0; s < plan_.shots.size(); ++s)
    sheets.push_back({plan_.shots[s], plan_.sheets[s].method, options_[s]});
  animation_.emplace(sheets);
}

/// states  gets one when this was the frame's last sheet, and the frame was not known before
void Candidate::Simulation::add(const AnimatedFrame& frame, std::vector<State>& states) {
  add_frame(now_.attempt, frame, plan_);
  bends_[frame.sheet_index].look(frame, plan_.shots[frame.sheet_index].pattern);
  if (frame.sheet_index + 1 < plan_.shots.size() || ++frames_ <= now_.attempt.frames) return;
  now_.attempt.frames = frames_;
  if (frames_ == frames_of(plan_))
    now_.attempt.coarse = std::any_of(bends_.begin(), bends_.end(),
                                      [](const BendWatch& bends) { return bends.is_creased(); });
  states.push_back(now_);
}

Candidate::Candidate(BakePlan plan, const Attempt& known, Comparison by, CandidateFolder folder,
                     StopRequest& stop, StageClock& clock)
    : plan_(std::move(plan)),
      by_(by),
      shown_{known},
      ahead_{known},
      simulation_(std::make_unique<Simulation>(plan_, known, std::move(folder), stop, clock)) {}

Candidate::~Candidate() = default;

bool Candidate::is_over(const State& state) const {
  return state.attempt.frames == frames_of(plan_);
}

bool Candidate::is_hopeless(const State& state) const {
  return std::isinf(badness(state)) || state.attempt.off_pct >= AttemptChoice::hopeless_pct;
}

double Candidate::badness(const State& state) const {
  return state.failed ? std::numeric_limits<double>::infinity()
                      : paperbake::badness(state.attempt, is_over(state), by_);
}

std::string Candidate::describe_state(std::size_t number, std::size_t of) const {
  const std::string so_far =
      by_.reason == AttemptReason::handle_off
          ? fmt::format("a handle is off by {:.1f} mm", 1e3 * known().off)
          : fmt::format("{} sharp point{}", known().points, known().points == 1 ? "" : "s");
  return fmt::format("attempt {} of {}: frame {} of {}, {} so far", number, of,
                     plan_.animation.first_frame + known().frames - 1, plan_.animation.last_frame,
                     so_far);
}

void Candidate::start(std::launch on) {
  task_ = std::async(on, [simulation = std::move(simulation_)]() mutable {
    std::vector<State> states = simulation->next_frame();
    return Simulated{std::move(simulation), std::move(states)};
  });
}

void Candidate::look() {
  if (task_.valid() && task_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    take_in();
}

void Candidate::take_in() {
  Simulated simulated = task_.get();
  simulation_ = std::move(simulated.simulation);
  for (State& state : simulated.states) not_shown_.push_back(std::move(state));
  if (!not_shown_.empty()) ahead_ = not_shown_.back();
}

void Candidate::show_frame() {
  begun_ = true;
  if (not_shown_.empty()) take_in();
  if (not_shown_.empty()) return;
  shown_ = std::move(not_shown_.front());
  not_shown_.pop_front();
}

}  // namespace paperbake
