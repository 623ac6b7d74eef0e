// What a SheetSimulation does for the elastic step of a frame: what drives it, how it goes back to
// where the step began, and where it is held when it cannot follow. The order is in island_step.h.

#include "core/animation/island_step.h"
#include "core/animation/motion_measures.h"
#include "core/model/error.h"

#include <algorithm>

namespace paperbake {
namespace {

/// Adds to the step of a part of the frame what the parts before it have taken.
void add_parts_before(FrameStepResult& step, const FrameStepResult& before) {
  step.substeps += before.substeps;
  step.iterations += before.iterations;
  step.converged &= before.converged;
  step.last.plastic_increment += before.last.plastic_increment;
}

}  // namespace

StepInput SheetSimulation::input_of_part(int part) const {
  StepInput input = now_.input;
  const double share = double(part) / now_.load_parts;
  for (PositionConstraint& c : input.constraints)
    if (const PositionConstraint* before = constraint_of(c.vertex, now_.came_from))
      c.target = (1 - share) * before->target + share * c.target;
  input.time -= (1 - share) / options_.fps;
  input.colliders.from = between(now_.input.colliders.from, now_.input.colliders.to, now_.followed);
  input.colliders.to = between(now_.input.colliders.from, now_.input.colliders.to, share);
  return input;
}

bool SheetSimulation::hold_if_infeasible() {
  if (now_.step.failure_reason.empty()) return false;
  if (frame_ == options_.first_frame)
    throw Error(ErrorCode::simulation, frame_interval({}).where, now_.step.failure_reason,
                "Let the sheet start where its handles are.");
  add_note("it stays as it was: " + now_.step.failure_reason);
  skip_step();
  now_.step.converged = false;
  for (PositionConstraint& c : resting_input_.constraints) c.target = sheet().x.row(c.vertex);
  return true;
}

DrivenSheet SheetSimulation::driven_sheet(RecordTrajectory trace) {
  return {simulated_.elastic,
          simulated_.sheet,
          now_.input,
          now_.relative_motion,
          simulated_.side,
          trace == RecordTrajectory::yes ? &now_.path_of_step : nullptr,
          {}};
}

DrivenSheet SheetSimulation::driven_in_part(RecordTrajectory trace, int part) {
  DrivenSheet driven = driven_sheet(trace);
  if (now_.load_parts == 1 && now_.followed == 0) return driven;
  driven.input = input_of_part(part);
  driven.relative_motion /= now_.load_parts;
  return driven;
}

FrameInterval SheetSimulation::frame_interval(const Eigen::MatrixXd& dhat_of_sheets) const {
  return {"frame " + std::to_string(frame_) + " of " + std::to_string(options_.last_frame),
          1 / options_.fps,
          simulated_.has_inertia() ? halvings_of_part()
          : jam_.is_on()           ? halvings_of_squeeze(now_.input.colliders)
                                   : 0,
          dhat_of_sheets};
}

void SheetSimulation::begin_step(RecordTrajectory trace) {
  if (trace == RecordTrajectory::yes || release_.is_on())
    now_.step_start.emplace(simulated_.sheet, simulated_.elastic);
  now_.path_of_step.clear();
}

bool SheetSimulation::may_step_in_parts() const { return now_.load_parts > 1 || shot_.colliders; }

void SheetSimulation::keep_frame_start() {
  if (now_.frame_start) return;
  Serializer now;
  archive(now);
  now_.frame_start.emplace(
      FrameStart{now.bytes(), simulated_.elastic.inertia(), release_, now_.result});
}

void SheetSimulation::undo_step() {
  if (!now_.frame_start) return roll_back();
  carried_.forget();
  Serializer frame_start(now_.frame_start->state);
  archive(frame_start);
  release_ = now_.frame_start->release;
  if (release_.was_let_go() && now_.frame_start->inertia == Inertia::dynamic)
    release_.give_inertia(simulated_);
  else
    simulated_.elastic.set_inertia(now_.frame_start->inertia);
  now_.result = now_.frame_start->result;
  now_.step_start.reset();
  now_.last_remesh.reset();
  now_.step = {};
  now_.followed = 0;
}

void SheetSimulation::roll_back() {
  if (now_.step_start) now_.step_start->restore(simulated_.sheet, simulated_.elastic);
}

void SheetSimulation::step(RecordTrajectory trace, const AdmissibilityCheck& is_admissible) {
  joined_ = false;
  if (now_.is_idle) return skip_step();
  // what a trial decides has to be undone, too
  if (trace == RecordTrajectory::yes && (may_step_in_parts() || release_.is_on()))
    keep_frame_start();
  const AdmissibilityOfSheet of_this = [&](std::size_t) { return is_admissible; };
  const bool refines = may_refine();
  for (;;) {
    std::optional<SimulatedSheet::MeshSnapshot> start;
    if (refines) start = simulated_.snapshot();
    IslandStep({this}, {{}, InitialGap::apart, of_this, trace}).take();
    if (!refines || !is_held_back_by_mesh() || !go_back_on_finer_mesh(*start, is_admissible)) break;
  }
  end_step();
}

void SheetSimulation::end_step() {
  if (!hold_if_infeasible()) hold_if_jammed();
  now_.trajectory.end(sheet());
}

void SheetSimulation::hold_if_jammed() {
  jam_.release();
  if (now_.step.followed == 1) return;
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

void SheetSimulation::end_part(FrameStepResult before, int part) {
  before.converged |= before.followed < 1;  // what was tried again
  add_parts_before(now_.step, before);
  outcome_.at_minimum = now_.step.converged && !now_.step.last.snap_in_progress;
  now_.followed += now_.step.followed * (double(part) / now_.load_parts - now_.followed);
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
    parts = std::max(parts, a->now_.load_parts);
  }
  for (SheetSimulation* a : all) {
    a->now_.load_parts = parts;
    if (a->may_step_in_parts()) a->keep_frame_start();
  }
  IslandStep(all, {dhat, gap, is_admissible, RecordTrajectory::yes}).take();
  for (SheetSimulation* a : all) {
    a->end_step();
    a->folds_.forget();
  }
}

}  // namespace paperbake
