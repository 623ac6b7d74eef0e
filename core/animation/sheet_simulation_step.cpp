// How a SheetSimulation takes the elastic step of a frame: in parts, together with other sheets,
// and what is left to do when it cannot.

#include "core/animation/sheet_simulation.h"
#include "core/geometry/measure.h"
#include "core/model/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace paperbake {

StepInput SheetSimulation::input_of_part(int part) const {
  StepInput input = input_;
  const double share = double(part) / load_parts_;
  for (PositionConstraint& c : input.constraints) {
    const auto before =
        std::find_if(came_from_.begin(), came_from_.end(),
                     [&](const PositionConstraint& other) { return other.vertex == c.vertex; });
    if (before != came_from_.end()) c.target = (1 - share) * before->target + share * c.target;
  }
  input.time -= (1 - share) / options_.fps;
  input.colliders.from = between(input_.colliders.from, input_.colliders.to, followed_);
  input.colliders.to = between(input_.colliders.from, input_.colliders.to, share);
  return input;
}

/// Holds a sheet that cannot follow its handles where it is, until they are where it can.
void SheetSimulation::hold_if_infeasible() {
  if (step_.failure_reason.empty()) return;
  if (frame_ == options_.first_frame)
    throw Error(ErrorCode::simulation, frame_interval({}).where, step_.failure_reason,
                "Let the sheet start where its handles are.");
  add_note("it stays as it was: " + step_.failure_reason);
  skip_step();
  step_.converged = false;
  for (PositionConstraint& c : input_before_.constraints) c.target = sheet().x.row(c.vertex);
}

DrivenSheet SheetSimulation::driven_sheet(RecordTrajectory trace) {
  return {simulated_.elastic,
          simulated_.sheet,
          input_,
          relative_motion_,
          simulated_.side,
          trace == RecordTrajectory::yes ? &trajectory_ : nullptr,
          {},
          may_jam()};
}

bool SheetSimulation::may_jam() const {
  return alone_ && shot_.colliders && input_.constraints.empty();
}

FrameInterval SheetSimulation::frame_interval(const Eigen::MatrixXd& dhat_of_sheets) const {
  return {"frame " + std::to_string(frame_) + " of " + std::to_string(options_.last_frame),
          1 / options_.fps,
          simulated_.has_inertia() ? inertial_halvings_
          : jam_.is_on()           ? halvings_of_squeeze(input_.colliders)
                                   : 0,
          dhat_of_sheets};
}

void SheetSimulation::begin_step(RecordTrajectory trace) {
  if (trace == RecordTrajectory::yes || release_.is_on()) step_start_ = simulated_.snapshot();
  if (trace == RecordTrajectory::yes) trajectory_ = {{0, sheet().x}};
}

void SheetSimulation::roll_back() {
  if (!step_start_) return;
  simulated_.sheet = step_start_->sheet;
  simulated_.elastic.restore(step_start_->state);
}

void SheetSimulation::step_part(RecordTrajectory trace, int part) {
  const auto take_step = [&] {
    begin_step(trace);
    DrivenSheet target = driven_sheet(trace);
    FrameInterval interval = frame_interval({});
    if (load_parts_ > 1 || followed_ > 0) {
      target.input = input_of_part(part);
      target.relative_motion /= load_parts_;
      interval.dt /= load_parts_;
    }
    step_ = advance_frame({target}, interval).front();
  };
  const auto take_unlocked_step = [&] {
    take_step();
    if (!is_locked()) return;
    undo_remesh();
    take_step();
  };
  take_unlocked_step();
  if (!end_trial()) return;
  roll_back();
  take_unlocked_step();
}

void SheetSimulation::step(RecordTrajectory trace) {
  if (is_idle_) return skip_step();
  const bool may_refine =
      alone_ && shot_.colliders && simulated_.has_inertia() && simulated_.is_smooth();
  for (;;) {
    std::optional<SimulatedSheet::Snapshot> begun;
    if (may_refine) begun = simulated_.snapshot();
    step_in_parts(trace);
    if (!may_refine || !is_held_back_by_mesh() || !refine_mesh(std::move(*begun))) break;
  }
  hold_if_infeasible();
  hold_if_jammed();
}

bool SheetSimulation::settle() {
  constexpr double pressed_less = 0.95;  // [1] of the largest stretch of an edge
  const double before = length_distortion(sheet()).largest;
  const SimulatedSheet::Snapshot begun = simulated_.snapshot();
  DrivenSheet target = driven_sheet(RecordTrajectory::no);
  ColliderMotion& at = target.input.colliders;
  at.from = at.to = between(at.from, at.to, followed_);
  FrameInterval interval = frame_interval({});
  interval.min_halvings = 0;
  const FrameStepResult rest = advance_frame({target}, interval).front();
  const double after = length_distortion(sheet()).largest;
  if (!rest.failure_reason.empty() || after > before || rest.last.inside > yield_depth) {
    restore(SimulatedSheet::Snapshot(begun));
    return false;
  }
  step_.substeps += rest.substeps;
  step_.iterations += rest.iterations;
  const double yielded = step_.last.plastic_increment;
  step_.last = rest.last;
  step_.last.plastic_increment += yielded;
  return after < pressed_less * before;
}

void SheetSimulation::hold_if_jammed() {
  jam_.release();
  if (step_.followed == 1 || !step_.failure_reason.empty()) return;
  jam_.hold(input_.colliders, followed_);
  if (followed_ == 0) {
    const FrameStepResult tried = step_;
    skip_step();
    step_.iterations = tried.iterations;
    step_.converged = false;
  }
  add_note(jam_.note(input_.colliders.to));
}

void SheetSimulation::step_in_parts(RecordTrajectory trace) {
  constexpr int most_refinements = 4;
  int refinements = 0;
  followed_ = 0;
  FrameStepResult before;
  for (int part = 1; part <= load_parts_ && step_.failure_reason.empty(); ++part) {
    const bool again = step_.followed < 1;
    if (part > 1 && !again && !std::exchange(folded_, false)) remesh(1.0 / load_parts_);
    before = step_;
    if (!again) remember(part);
    step_part(trace, part);
    step_.substeps += before.substeps;
    step_.iterations += before.iterations;
    step_.converged &= before.converged || again;
    outcome_.at_minimum = step_.converged && !step_.last.snap_in_progress;
    step_.last.plastic_increment += before.last.plastic_increment;
    followed_ += step_.followed * (double(part) / load_parts_ - followed_);
    if (step_.followed < 1) {
      const bool finer = refinements++ < most_refinements && refine_where_jammed();
      const bool stays = !finer && followed_ == 0 && jam_.is_on();
      if (refinements > most_refinements || stays) return;
      if (!settle() && !finer) return;
      --part;
    } else if (part < load_parts_) {
      followed_ = double(part) / load_parts_;
      note_outcome();
      fold_if_bent([](const Sheet&, const Sheet&, double) { return true; });
    }
  }
}

void SheetSimulation::step_together(const std::vector<SheetSimulation*>& all,
                                    const Eigen::MatrixXd& dhat, InitialGap gap) {
  const auto take_step = [&] {
    std::vector<DrivenSheet> followers;
    FrameInterval interval = all.front()->frame_interval(dhat);
    for (SheetSimulation* a : all) {
      a->is_idle_ = a->is_sleeping_ = false;
      a->begin_step(RecordTrajectory::yes);
      followers.push_back(a->driven_sheet(RecordTrajectory::yes));
      if (gap == InitialGap::within_dhat)
        followers.back().initial_positions = a->initial_positions();
      interval.min_halvings = std::max(interval.min_halvings, a->frame_interval({}).min_halvings);
    }
    const std::vector<FrameStepResult> steps = advance_frame(followers, interval);
    for (std::size_t k = 0; k < all.size(); ++k) all[k]->step_ = steps[k];
  };
  const auto take_unlocked_step = [&] {
    for (SheetSimulation* a : all) a->roll_back();
    take_step();
    const auto is_locked = [](const SheetSimulation* a) { return a->is_locked(); };
    if (std::none_of(all.begin(), all.end(), is_locked)) return;
    for (SheetSimulation* a : all)
      if (is_locked(a))
        a->undo_remesh();
      else
        a->roll_back();
    take_step();
  };
  take_unlocked_step();
  bool again = false;
  for (SheetSimulation* a : all) again |= a->end_trial();
  if (again) take_unlocked_step();
  for (SheetSimulation* a : all) a->hold_if_infeasible();
}

}  // namespace paperbake
