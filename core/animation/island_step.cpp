#include "core/animation/island_step.h"

#include "core/geometry/measure.h"

#include <algorithm>
#include <utility>

namespace paperbake {

SheetSimulation::IslandStep::IslandStep(std::vector<SheetSimulation*> sheets, Conditions conditions)
    : sheets_(std::move(sheets)), conditions_(std::move(conditions)) {}

void SheetSimulation::IslandStep::take() {
  const int parts = first().now_.load_parts;
  for (SheetSimulation* a : sheets_) {
    a->now_.followed = 0;
    a->now_.trajectory.begin(a->sheet());
  }
  for (int part = 1; part <= parts && first().now_.step.failure_reason.empty(); ++part) {
    if (!is_jammed())
      for (SheetSimulation* a : sheets_) {
        if (part > 1 && !std::exchange(a->folded_, false))
          a->change_mesh(a->remesh_context(1.0 / parts), conditions_.is_admissible(a->number_));
        a->remember(part);
      }
    take_part(part);
    if (is_jammed()) {
      if (!give_way_to_jam()) return;
      --part;
    } else if (part < parts) {
      for (SheetSimulation* a : sheets_) {
        a->now_.followed = double(part) / parts;
        a->note_outcome();
      }
      if (sheets_.size() == 1) first().fold_if_bent(conditions_.is_admissible(first().number_));
    }
  }
}

void SheetSimulation::IslandStep::take_part(int part) {
  const int parts = first().now_.load_parts;
  const double part_start =
      first().now_.followed > 0 ? first().now_.followed : double(part - 1) / parts;
  std::vector<FrameStepResult> before;
  for (const SheetSimulation* a : sheets_) before.push_back(a->now_.step);
  advance_unlocked(part);
  bool again = false;
  for (SheetSimulation* a : sheets_) again |= a->end_trial();
  if (again) {
    for (SheetSimulation* a : sheets_) a->roll_back();
    advance_unlocked(part);
  }
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    SheetSimulation& a = *sheets_[k];
    if (conditions_.trace == RecordTrajectory::yes)
      a.now_.trajectory.append(a.sheet(), a.now_.path_of_step, part_start, double(part) / parts);
    a.end_part(before[k], part);
  }
}

void SheetSimulation::IslandStep::advance_unlocked(int part) {
  advance(part);
  const auto is_locked = [](const SheetSimulation* a) { return a->is_locked(); };
  if (std::none_of(sheets_.begin(), sheets_.end(), is_locked)) return;
  for (SheetSimulation* a : sheets_)
    if (is_locked(a))
      a->undo_remesh();
    else
      a->roll_back();
  advance(part);
}

void SheetSimulation::IslandStep::advance(int part) {
  std::vector<DrivenSheet> driven;
  FrameInterval interval = first().frame_interval(conditions_.dhat);
  interval.dt /= first().now_.load_parts;
  for (SheetSimulation* a : sheets_) {
    a->begin_step(conditions_.trace);
    driven.push_back(with_initial_positions(*a, a->driven_in_part(conditions_.trace, part)));
    interval.min_halvings = std::max(interval.min_halvings, a->frame_interval({}).min_halvings);
  }
  const std::vector<FrameStepResult> steps = advance_frame(driven, interval);
  for (std::size_t k = 0; k < sheets_.size(); ++k) sheets_[k]->now_.step = steps[k];
}

DrivenSheet SheetSimulation::IslandStep::with_initial_positions(SheetSimulation& sheet,
                                                                DrivenSheet driven) const {
  if (conditions_.gap == InitialGap::within_dhat)
    driven.initial_positions = sheet.initial_positions();
  return driven;
}

bool SheetSimulation::IslandStep::give_way_to_jam() {
  constexpr int most_refinements = 4;
  const bool has_tries_left = refinements_++ < most_refinements;
  bool finer = false, stays = first().now_.followed == 0;
  for (SheetSimulation* a : sheets_) {
    finer |= has_tries_left && a->refine_where_jammed(conditions_.is_admissible(a->number_));
    stays &= a->jam_.is_on();
  }
  if (!has_tries_left || (stays && !finer)) return false;
  return settle() || finer;
}

bool SheetSimulation::IslandStep::settle() {
  constexpr double pressed_less = 0.95;  // [1] of the largest stretch of an edge
  const auto stretch = [&] {
    double most = 0;
    for (const SheetSimulation* a : sheets_) most = std::max(most, worst_edge(a->sheet()).error);
    return most;
  };
  const double before = stretch();
  std::vector<SimulatedSheet::MeshSnapshot> jammed;
  std::vector<DrivenSheet> targets;
  for (SheetSimulation* a : sheets_) {
    jammed.push_back(a->simulated_.snapshot());
    targets.push_back(with_initial_positions(*a, a->driven_sheet(RecordTrajectory::no)));
    ColliderMotion& at = targets.back().input.colliders;
    at.from = at.to = between(at.from, at.to, a->now_.followed);
  }
  FrameInterval interval = first().frame_interval(conditions_.dhat);
  interval.min_halvings = 0;
  const std::vector<FrameStepResult> rest = advance_frame(targets, interval);
  const double after = stretch();
  const bool crushed = std::any_of(rest.begin(), rest.end(), [](const FrameStepResult& step) {
    return !step.failure_reason.empty() || step.last.inside > give_way_depth;
  });
  for (std::size_t k = 0; k < sheets_.size(); ++k) {
    if (crushed || after > before) {
      sheets_[k]->restore(jammed[k]);
      continue;
    }
    sheets_[k]->now_.last_remesh.reset();  // the sheet has moved on since then
    FrameStepResult& step = sheets_[k]->now_.step;
    step.substeps += rest[k].substeps;
    step.iterations += rest[k].iterations;
    const double yielded = step.last.plastic_increment;
    step.last = rest[k].last;
    step.last.plastic_increment += yielded;
  }
  return !crushed && after < pressed_less * before;
}

}  // namespace paperbake
