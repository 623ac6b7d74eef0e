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
          trace == RecordTrajectory::yes ? &path_of_step_ : nullptr,
          {},
          may_jam()};
}

DrivenSheet SheetSimulation::driven_in_part(RecordTrajectory trace, int part) {
  DrivenSheet driven = driven_sheet(trace);
  if (load_parts_ == 1 && followed_ == 0) return driven;
  driven.input = input_of_part(part);
  driven.relative_motion /= load_parts_;
  return driven;
}

bool SheetSimulation::may_jam() const {
  return !joined_ && shot_.colliders && input_.constraints.empty();
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
  path_of_step_.clear();
}

bool SheetSimulation::may_step_in_parts() const {
  return load_parts_ > 1 || may_jam() || may_refine();
}

void SheetSimulation::keep_frame_start() {
  if (frame_start_) return;
  Serializer begun;
  archive(begun);
  frame_start_.emplace(FrameStart{begun.bytes(), simulated_.elastic.inertia(), release_, result_});
}

void SheetSimulation::undo_step() {
  if (!frame_start_) return roll_back();
  carried_.forget();
  simulated_.elastic.set_inertia(frame_start_->inertia);
  Serializer begun(frame_start_->state);
  archive(begun);
  release_ = frame_start_->release;
  result_ = frame_start_->result;
  step_start_.reset();
  last_remesh_.reset();
  step_ = {};
  followed_ = 0;
}

void SheetSimulation::roll_back() {
  if (!step_start_) return;
  simulated_.sheet = step_start_->sheet;
  simulated_.elastic.restore(step_start_->state);
}

void SheetSimulation::step_part(RecordTrajectory trace, int part) {
  const double begun = followed_ > 0 ? followed_ : double(part - 1) / load_parts_;
  const auto take_step = [&] {
    begin_step(trace);
    FrameInterval interval = frame_interval({});
    interval.dt /= load_parts_;
    step_ = advance_frame({driven_in_part(trace, part)}, interval).front();
  };
  const auto take_unlocked_step = [&] {
    take_step();
    if (!is_locked()) return;
    undo_remesh();
    take_step();
  };
  take_unlocked_step();
  if (end_trial()) {
    roll_back();
    take_unlocked_step();
  }
  if (trace == RecordTrajectory::yes)
    trajectory_.append(sheet(), path_of_step_, begun, double(part) / load_parts_);
}

void SheetSimulation::step(RecordTrajectory trace, const AdmissibilityCheck& is_admissible) {
  joined_ = false;
  if (is_idle_) return skip_step();
  if (trace == RecordTrajectory::yes && may_step_in_parts()) keep_frame_start();
  const bool refines = may_refine();
  for (;;) {
    std::optional<SimulatedSheet::Snapshot> begun;
    if (refines) begun = simulated_.snapshot();
    trajectory_.begin(sheet());
    step_in_parts(trace, is_admissible);
    if (!refines || !is_held_back_by_mesh() || !refine_mesh(std::move(*begun))) break;
  }
  hold_if_infeasible();
  hold_if_jammed();
  trajectory_.end(sheet());
}

/// Adds what the parts of the frame before the last one have taken.
void SheetSimulation::add_to_step(const FrameStepResult& before) {
  step_.substeps += before.substeps;
  step_.iterations += before.iterations;
  step_.converged &= before.converged;
  step_.last.plastic_increment += before.last.plastic_increment;
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

void SheetSimulation::step_in_parts(RecordTrajectory trace,
                                    const AdmissibilityCheck& is_admissible) {
  constexpr int most_refinements = 4;
  int refinements = 0;
  followed_ = 0;
  FrameStepResult before;
  for (int part = 1; part <= load_parts_ && step_.failure_reason.empty(); ++part) {
    const bool again = step_.followed < 1;
    if (part > 1 && !again && !std::exchange(folded_, false))
      remesh(1.0 / load_parts_, is_admissible);
    before = step_;
    if (!again) remember(part);
    step_part(trace, part);
    before.converged |= again;
    add_to_step(before);
    outcome_.at_minimum = step_.converged && !step_.last.snap_in_progress;
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
      fold_if_bent(is_admissible);
    }
  }
}

void SheetSimulation::step_part_together(const std::vector<SheetSimulation*>& all,
                                         const Eigen::MatrixXd& dhat, InitialGap gap, int part) {
  const auto take_step = [&] {
    std::vector<DrivenSheet> followers;
    FrameInterval interval = all.front()->frame_interval(dhat);
    interval.dt /= all.front()->load_parts_;
    for (SheetSimulation* a : all) {
      a->begin_step(RecordTrajectory::yes);
      followers.push_back(a->driven_in_part(RecordTrajectory::yes, part));
      if (gap == InitialGap::within_dhat)
        followers.back().initial_positions = a->initial_positions();
      interval.min_halvings = std::max(interval.min_halvings, a->frame_interval({}).min_halvings);
    }
    const std::vector<FrameStepResult> steps = advance_frame(followers, interval);
    for (std::size_t k = 0; k < all.size(); ++k) all[k]->step_ = steps[k];
  };
  const auto take_unlocked_step = [&] {
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
  if (!again) return;
  for (SheetSimulation* a : all) a->roll_back();
  take_unlocked_step();
}

void SheetSimulation::step_together(
    const std::vector<SheetSimulation*>& all, const Eigen::MatrixXd& dhat, InitialGap gap,
    const std::function<AdmissibilityCheck(std::size_t)>& is_admissible) {
  int parts = 1;
  for (SheetSimulation* a : all) {
    a->undo_step();
    a->joined_ = true;
    a->is_idle_ = a->is_sleeping_ = false;
    a->trajectory_.begin(a->sheet());
    parts = std::max(parts, a->load_parts_);
  }
  for (SheetSimulation* a : all) {
    a->load_parts_ = parts;
    if (parts > 1) a->keep_frame_start();
  }
  for (int part = 1; part <= parts; ++part) {
    std::vector<FrameStepResult> before;
    for (SheetSimulation* a : all) {
      if (part > 1) a->remesh(1.0 / parts, is_admissible(a->number_));
      before.push_back(a->step_);
    }
    step_part_together(all, dhat, gap, part);
    for (std::size_t k = 0; k < all.size(); ++k) {
      SheetSimulation& a = *all[k];
      a.trajectory_.append(a.sheet(), a.path_of_step_, double(part - 1) / parts,
                           double(part) / parts);
      if (part > 1) a.add_to_step(before[k]);
      a.followed_ = double(part) / parts;
      a.outcome_.at_minimum = a.step_.converged && !a.step_.last.snap_in_progress;
      if (part < parts) a.note_outcome();
    }
    if (!all.front()->step_.failure_reason.empty()) break;
  }
  for (SheetSimulation* a : all) {
    a->hold_if_infeasible();
    a->trajectory_.end(a->sheet());
    a->jam_.release();
    a->folds_.forget();
  }
}

}  // namespace paperbake
