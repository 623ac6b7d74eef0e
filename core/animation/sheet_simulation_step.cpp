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
  StepInput input = now_.input;
  const double share = double(part) / now_.load_parts;
  for (PositionConstraint& c : input.constraints) {
    const auto before =
        std::find_if(now_.came_from.begin(), now_.came_from.end(),
                     [&](const PositionConstraint& other) { return other.vertex == c.vertex; });
    if (before != now_.came_from.end()) c.target = (1 - share) * before->target + share * c.target;
  }
  input.time -= (1 - share) / options_.fps;
  input.colliders.from = between(now_.input.colliders.from, now_.input.colliders.to, now_.followed);
  input.colliders.to = between(now_.input.colliders.from, now_.input.colliders.to, share);
  return input;
}

/// Holds a sheet that cannot follow its handles where it is, until they are where it can.
void SheetSimulation::hold_if_infeasible() {
  if (now_.step.failure_reason.empty()) return;
  if (frame_ == options_.first_frame)
    throw Error(ErrorCode::simulation, frame_interval({}).where, now_.step.failure_reason,
                "Let the sheet start where its handles are.");
  add_note("it stays as it was: " + now_.step.failure_reason);
  skip_step();
  now_.step.converged = false;
  for (PositionConstraint& c : input_before_.constraints) c.target = sheet().x.row(c.vertex);
}

DrivenSheet SheetSimulation::driven_sheet(RecordTrajectory trace) {
  return {simulated_.elastic,
          simulated_.sheet,
          now_.input,
          now_.relative_motion,
          simulated_.side,
          trace == RecordTrajectory::yes ? &now_.path_of_step : nullptr,
          {},
          may_jam()};
}

DrivenSheet SheetSimulation::driven_in_part(RecordTrajectory trace, int part) {
  DrivenSheet driven = driven_sheet(trace);
  if (now_.load_parts == 1 && now_.followed == 0) return driven;
  driven.input = input_of_part(part);
  driven.relative_motion /= now_.load_parts;
  return driven;
}

bool SheetSimulation::may_jam() const { return shot_.colliders && now_.input.constraints.empty(); }

FrameInterval SheetSimulation::frame_interval(const Eigen::MatrixXd& dhat_of_sheets) const {
  return {"frame " + std::to_string(frame_) + " of " + std::to_string(options_.last_frame),
          1 / options_.fps,
          simulated_.has_inertia() ? halvings_of_part()
          : jam_.is_on()           ? halvings_of_squeeze(now_.input.colliders)
                                   : 0,
          dhat_of_sheets};
}

void SheetSimulation::begin_step(RecordTrajectory trace) {
  if (trace == RecordTrajectory::yes || release_.is_on()) now_.step_start = simulated_.snapshot();
  now_.path_of_step.clear();
}

bool SheetSimulation::may_step_in_parts() const {
  return now_.load_parts > 1 || may_jam() || may_refine();
}

void SheetSimulation::keep_frame_start() {
  if (now_.frame_start) return;
  Serializer begun;
  archive(begun);
  now_.frame_start.emplace(
      FrameStart{begun.bytes(), simulated_.elastic.inertia(), release_, now_.result});
}

void SheetSimulation::undo_step() {
  if (!now_.frame_start) return roll_back();
  carried_.forget();
  simulated_.elastic.set_inertia(now_.frame_start->inertia);
  Serializer begun(now_.frame_start->state);
  archive(begun);
  release_ = now_.frame_start->release;
  now_.result = now_.frame_start->result;
  now_.step_start.reset();
  now_.last_remesh.reset();
  now_.step = {};
  now_.followed = 0;
}

void SheetSimulation::roll_back() {
  if (!now_.step_start) return;
  simulated_.sheet = now_.step_start->sheet;
  simulated_.elastic.restore(now_.step_start->state);
}

void SheetSimulation::step_part(RecordTrajectory trace, int part) {
  const double begun = now_.followed > 0 ? now_.followed : double(part - 1) / now_.load_parts;
  const auto take_step = [&] {
    begin_step(trace);
    FrameInterval interval = frame_interval({});
    interval.dt /= now_.load_parts;
    now_.step = advance_frame({driven_in_part(trace, part)}, interval).front();
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
    now_.trajectory.append(sheet(), now_.path_of_step, begun, double(part) / now_.load_parts);
}

void SheetSimulation::step(RecordTrajectory trace, const AdmissibilityCheck& is_admissible) {
  joined_ = false;
  if (now_.is_idle) return skip_step();
  if (trace == RecordTrajectory::yes && may_step_in_parts()) keep_frame_start();
  const bool refines = may_refine();
  for (;;) {
    std::optional<SimulatedSheet::Snapshot> begun;
    if (refines) begun = simulated_.snapshot();
    now_.trajectory.begin(sheet());
    step_in_parts(trace, is_admissible);
    if (!refines || !is_held_back_by_mesh() || !refine_mesh(std::move(*begun))) break;
  }
  hold_if_infeasible();
  hold_if_jammed();
  now_.trajectory.end(sheet());
}

/// Adds what the parts of the frame before the last one have taken.
void SheetSimulation::add_to_step(const FrameStepResult& before) {
  now_.step.substeps += before.substeps;
  now_.step.iterations += before.iterations;
  now_.step.converged &= before.converged;
  now_.step.last.plastic_increment += before.last.plastic_increment;
}

bool SheetSimulation::settle(const std::vector<SheetSimulation*>& all, const Eigen::MatrixXd& dhat,
                             InitialGap gap) {
  constexpr double pressed_less = 0.95;  // [1] of the largest stretch of an edge
  const auto stretch = [&] {
    double most = 0;
    for (const SheetSimulation* a : all)
      most = std::max(most, length_distortion(a->sheet()).largest);
    return most;
  };
  const double before = stretch();
  std::vector<SimulatedSheet::Snapshot> begun;
  std::vector<DrivenSheet> targets;
  for (SheetSimulation* a : all) {
    begun.push_back(a->simulated_.snapshot());
    targets.push_back(a->driven_sheet(RecordTrajectory::no));
    if (gap == InitialGap::within_dhat) targets.back().initial_positions = a->initial_positions();
    ColliderMotion& at = targets.back().input.colliders;
    at.from = at.to = between(at.from, at.to, a->now_.followed);
  }
  FrameInterval interval = all.front()->frame_interval(dhat);
  interval.min_halvings = 0;
  const std::vector<FrameStepResult> rest = advance_frame(targets, interval);
  const double after = stretch();
  const bool crushed = std::any_of(rest.begin(), rest.end(), [](const FrameStepResult& step) {
    return !step.failure_reason.empty() || step.last.inside > give_way_depth;
  });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (crushed || after > before) {
      all[k]->restore(std::move(begun[k]));
      continue;
    }
    all[k]->now_.last_remesh.reset();  // the sheet has moved on since then
    FrameStepResult& step = all[k]->now_.step;
    step.substeps += rest[k].substeps;
    step.iterations += rest[k].iterations;
    const double yielded = step.last.plastic_increment;
    step.last = rest[k].last;
    step.last.plastic_increment += yielded;
  }
  return !crushed && after < pressed_less * before;
}

void SheetSimulation::hold_if_jammed() {
  jam_.release();
  if (now_.step.followed == 1 || !now_.step.failure_reason.empty()) return;
  jam_.hold(now_.input.colliders, now_.followed);
  if (now_.followed == 0) {
    const FrameStepResult tried = now_.step;
    skip_step();
    now_.step.iterations = tried.iterations;
    now_.step.last.touching_others = tried.last.touching_others;
    now_.step.converged = false;
  }
  add_note(jam_.note(now_.input.colliders.to));
}

bool SheetSimulation::give_way_to_jam(const std::vector<SheetSimulation*>& all,
                                      const Eigen::MatrixXd& dhat, InitialGap gap,
                                      const AdmissibilityOfSheet& is_admissible, int& refinements) {
  constexpr int most_refinements = 4;
  const bool may_refine = refinements++ < most_refinements;
  bool finer = false, stays = all.front()->now_.followed == 0;
  for (SheetSimulation* a : all) {
    finer |= may_refine && a->refine_where_jammed(is_admissible(a->number_));
    stays &= a->jam_.is_on();
  }
  if (!may_refine || (stays && !finer)) return false;
  return settle(all, dhat, gap) || finer;
}

void SheetSimulation::end_part(FrameStepResult before, int part) {
  before.converged |= before.followed < 1;  // what was tried again
  add_to_step(before);
  outcome_.at_minimum = now_.step.converged && !now_.step.last.snap_in_progress;
  now_.followed += now_.step.followed * (double(part) / now_.load_parts - now_.followed);
}

void SheetSimulation::step_in_parts(RecordTrajectory trace,
                                    const AdmissibilityCheck& is_admissible) {
  const AdmissibilityOfSheet of_this = [&](std::size_t) { return is_admissible; };
  int refinements = 0;
  now_.followed = 0;
  for (int part = 1; part <= now_.load_parts && now_.step.failure_reason.empty(); ++part) {
    const bool again = now_.step.followed < 1;
    if (part > 1 && !again && !std::exchange(folded_, false))
      change_mesh(remesh_context(1.0 / now_.load_parts), is_admissible);
    const FrameStepResult before = now_.step;
    if (!again) remember(part);
    step_part(trace, part);
    end_part(before, part);
    if (now_.step.followed < 1) {
      if (!give_way_to_jam({this}, {}, InitialGap::apart, of_this, refinements)) return;
      --part;
    } else if (part < now_.load_parts) {
      now_.followed = double(part) / now_.load_parts;
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
    interval.dt /= all.front()->now_.load_parts;
    for (SheetSimulation* a : all) {
      a->begin_step(RecordTrajectory::yes);
      followers.push_back(a->driven_in_part(RecordTrajectory::yes, part));
      if (gap == InitialGap::within_dhat)
        followers.back().initial_positions = a->initial_positions();
      interval.min_halvings = std::max(interval.min_halvings, a->frame_interval({}).min_halvings);
    }
    const std::vector<FrameStepResult> steps = advance_frame(followers, interval);
    for (std::size_t k = 0; k < all.size(); ++k) all[k]->now_.step = steps[k];
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

void SheetSimulation::step_together(const std::vector<SheetSimulation*>& all,
                                    const Eigen::MatrixXd& dhat, InitialGap gap,
                                    const AdmissibilityOfSheet& is_admissible) {
  int parts = 1;
  for (SheetSimulation* a : all) {
    a->undo_step();
    a->joined_ = true;
    a->now_.is_idle = a->now_.is_sleeping = false;
    a->now_.step = {};
    a->now_.followed = 0;
    a->now_.trajectory.begin(a->sheet());
    parts = std::max(parts, a->now_.load_parts);
  }
  for (SheetSimulation* a : all) {
    a->now_.load_parts = parts;
    if (parts > 1 || a->may_jam()) a->keep_frame_start();
  }
  int refinements = 0;
  for (int part = 1; part <= parts && all.front()->now_.step.failure_reason.empty(); ++part) {
    const bool again = all.front()->now_.step.followed < 1;
    std::vector<FrameStepResult> before;
    for (SheetSimulation* a : all) {
      if (part > 1 && !again)
        a->change_mesh(a->remesh_context(1.0 / parts), is_admissible(a->number_));
      before.push_back(a->now_.step);
    }
    const double begun = again ? all.front()->now_.followed : static_cast<double>(part - 1) / parts;
    step_part_together(all, dhat, gap, part);
    for (std::size_t k = 0; k < all.size(); ++k) {
      SheetSimulation& a = *all[k];
      a.now_.trajectory.append(a.sheet(), a.now_.path_of_step, begun, double(part) / parts);
      a.end_part(before[k], part);
    }
    if (all.front()->now_.step.followed < 1) {
      if (!give_way_to_jam(all, dhat, gap, is_admissible, refinements)) break;
      --part;
      continue;
    }
    for (SheetSimulation* a : all) {
      a->now_.followed = static_cast<double>(part) / parts;
      if (part < parts) a->note_outcome();
    }
  }
  for (SheetSimulation* a : all) {
    a->hold_if_infeasible();
    a->hold_if_jammed();
    a->now_.trajectory.end(a->sheet());
    a->folds_.forget();
  }
}

}  // namespace paperbake
