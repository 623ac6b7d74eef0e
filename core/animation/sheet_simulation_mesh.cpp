// How a SheetSimulation changes its mesh: as its method does between steps, where the old mesh
// locks or jams, and where the sheet folds.

#include "core/animation/motion_measures.h"
#include "core/animation/sheet_simulation.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_coarseness.h"

#include <algorithm>
#include <utility>

namespace paperbake {
namespace {

// [1] of the longer side: with less motion than this no method changes the mesh
constexpr double motion_threshold = 2e-4;
// [1] of the shorter side: a handle is isolated when no other one is nearer on the pattern
constexpr double isolated = 0.15;
constexpr double jammed_stretch = 0.01;  // [1] |l - L|/L of an edge

}  // namespace

RemeshContext SheetSimulation::remesh_context(double share) {
  const Sheet& sheet = simulated_.sheet;
  const double side = simulated_.side, least_motion = motion_threshold * side;
  RemeshContext context(simulated_.fixed);
  if (simulated_.plastic_grid) context.plastic_grid = &*simulated_.plastic_grid;
  context.isolated_moving_handles = isolated_moving_handles(
      sheet, now_.input.constraints, least_motion, isolated * shorter_side(shot_.pattern));
  context.now = {frame_, 1 / options_.fps, now_.max_motion / side};
  context.moving = now_.max_motion > least_motion;
  context.snap_in_progress = outcome_.snap_in_progress;
  context.at_minimum = outcome_.at_minimum;
  context.yielding = yielding_;
  context.rests_on_contact = outcome_.rests_on_contact;
  context.relative_handle_motion = share * now_.relative_motion;
  context.deformation = share * rms_deformation(simulated_.positions_before, sheet.x) / side;
  context.squeeze = share * now_.squeeze;
  context.local_energies = [this] { return simulated_.elastic.local_energies(simulated_.sheet); };
  return context;
}

bool SheetSimulation::change_mesh(const RemeshContext& context,
                                  const AdmissibilityCheck& is_admissible) {
  Sheet& sheet = simulated_.sheet;
  Sheet unchanged = sheet;
  now_.last_remesh.reset();
  const MeshChange change = method_->remesh(sheet, context);
  if (change == MeshChange::none) return false;
  SimulatedSheet::MeshSnapshot before = simulated_.snapshot();
  before.sheet = std::move(unchanged);
  now_.last_remesh = {std::move(before), outcome_.at_minimum, change == MeshChange::moved};
  if (now_.last_remesh->vertices_moved)
    simulated_.carry_over(now_.last_remesh->before.sheet);
  else
    simulated_.update_solver();
  if (const Sheet& as_it_was = now_.last_remesh->before.sheet;
      !cuts_into_collider(as_it_was) && is_admissible(as_it_was, sheet, 0))
    return true;
  undo_remesh();
  return false;
}

void SheetSimulation::undo_remesh() {
  restore(now_.last_remesh->before);
  now_.last_remesh.reset();
}

bool SheetSimulation::cuts_into_collider(const Sheet& before) const {
  if (outcome_.on_colliders == 0) return false;
  const ColliderShapes now =
      now_.followed > 0 ? between(now_.input.colliders.from, now_.input.colliders.to, now_.followed)
                        : now_.input.colliders.from;
  const double depth = simulated_.elastic.inside(sheet(), now);
  return depth > tolerated_depth_of_change &&
         depth > simulated_.elastic.inside_on_mesh_of(before, now);
}

bool SheetSimulation::is_locked() const {
  if (!now_.last_remesh || !now_.step.last.contact || now_.step.converged) return false;
  return (now_.last_remesh->vertices_moved &&
          (now_.last_remesh->was_at_minimum || now_.squeeze == 0)) ||
         worst_edge(sheet()).error >
             std::max(jammed_stretch, 4 * worst_edge(now_.last_remesh->before.sheet).error);
}

void SheetSimulation::try_proposal(const RemeshContext& context,
                                   const AdmissibilityCheck& is_admissible) {
  Sheet& sheet = simulated_.sheet;
  std::optional<Sheet> proposal = method_->propose(sheet, context);
  if (!proposal) return;
  std::vector<double> stiffening = disc_factors(*proposal, shot_);
  const MeshSwapResult verdict =
      try_swap_mesh(sheet, simulated_.elastic, {std::move(*proposal), std::move(stiffening)},
                    resting_input_, 1 / options_.fps, is_admissible);
  method_->on_proposal_result(verdict.accepted, context.now);
  now_.result.statistics.remesh =
      verdict.accepted ? FrameStatistics::accepted : FrameStatistics::rejected;
  now_.result.statistics.remesh_rise = verdict.rise;
  if (!verdict.accepted) return;
  simulated_.has_bends = false;
  carried_.carry(simulated_, *method_, sheet.x, 1 / options_.fps);
}

bool SheetSimulation::refine_mesh(const SimulatedSheet::MeshSnapshot& start, int doublings) {
  std::optional<PatternMesh> finer;
  while (doublings-- > 0 && method_->has_finer_mesh() && method_->doublings() < doublings_to_bend)
    finer = method_->finer_mesh();
  if (!finer) return false;
  restore(start);
  simulated_.put_on(std::move(*finer));
  now_.last_remesh.reset();
  folds_.forget();
  now_.step = {};
  return true;
}

bool SheetSimulation::go_back_on_finer_mesh(const SimulatedSheet::MeshSnapshot& start,
                                            const AdmissibilityCheck& is_admissible) {
  const SimulatedSheet::MeshSnapshot end = simulated_.snapshot();
  const FrameStepResult step = now_.step;
  if (!refine_mesh(start, stretches_instead_of_bending() ? doublings_to_bend : 1)) return false;
  if (leave_colliders(is_admissible)) return true;
  restore(end);
  now_.step = step;
  return false;
}

bool SheetSimulation::leave_colliders(const AdmissibilityCheck& is_admissible) {
  const Sheet before = sheet();
  if (!simulated_.elastic.leave_colliders(simulated_.sheet, now_.input.colliders.from,
                                          now_.input.constraints))
    return false;
  const bool is_pushed = !same_entries(before.x, sheet().x);
  return !is_pushed || (crossings(sheet()) == 0 && is_admissible(before, sheet(), 0));
}

bool SheetSimulation::is_held_back_by_mesh() const {
  return now_.step.failure_reason.empty() && now_.step.last.on_colliders > 0 &&
         simulated_.is_smooth() &&
         (mean_square_fold(sheet()) > fold_that_hooks || stretches_instead_of_bending());
}

bool SheetSimulation::may_refine() const {
  return shot_.colliders && simulated_.has_inertia() && simulated_.is_smooth();
}

bool SheetSimulation::is_rehearsed() const {
  return shot_.colliders && !simulated_.has_inertia() && simulated_.is_smooth();
}

bool SheetSimulation::may_start_finer() const {
  return is_rehearsed() && method_->has_finer_mesh();
}

bool SheetSimulation::rests_on_coarse_folds() const {
  return outcome_.on_colliders > 0 && mean_square_fold(sheet()) > fold_that_holds;
}

bool SheetSimulation::stretches_instead_of_bending() const {
  if (!now_.step.failure_reason.empty() || !simulated_.is_smooth()) return false;
  const double share = now_.step.last.membrane_share(), fold = mean_square_fold(sheet());
  return (share > ridge_share && fold > fold_that_hooks) ||
         (share > 2 * ridge_share && fold > fold_that_shows);
}

bool SheetSimulation::refine_where_jammed(const AdmissibilityCheck& is_admissible) {
  if (simulated_.is_smooth()) return refine_jammed_smooth_mesh(is_admissible);
  RemeshContext context = remesh_context(1);
  context.jammed = true;
  return change_mesh(context, is_admissible);
}

bool SheetSimulation::refine_jammed_smooth_mesh(const AdmissibilityCheck& is_admissible) {
  const SimulatedSheet::MeshSnapshot kept = simulated_.snapshot();
  const FrameStepResult jammed = now_.step;
  const ColliderShapes now =
      between(now_.input.colliders.from, now_.input.colliders.to, now_.followed);
  const double depth = simulated_.elastic.inside(sheet(), now);
  if (!refine_mesh(kept, 1)) return false;
  now_.step = jammed;
  if (crossings(sheet()) == 0 && is_admissible(kept.sheet, sheet(), 0) &&
      simulated_.elastic.inside(sheet(), now) <= std::max(depth, give_way_depth))
    return true;
  restore(kept);
  return false;
}

void SheetSimulation::fold_if_bent(const AdmissibilityCheck& is_admissible) {
  const LoadStep now{resting_input_, 1 / options_.fps, 0, frame_ - options_.first_frame, 0};
  std::optional<FoundFold> fold =
      folds_.find(now, {outcome_.yielded, outcome_.on_colliders > 0}, is_admissible);
  if (!fold) return;
  carried_.forget();
  folds_.forget();
  simulated_.sheet = std::move(fold->sheet);
  simulated_.elastic = std::move(fold->elastic);
  simulated_.fixed = std::move(fold->fixed);
  simulated_.positions_before = sheet().x;
  fold->step.substeps += now_.step.substeps;
  fold->step.iterations += now_.step.iterations;
  now_.step = std::move(fold->step);
  now_.last_remesh.reset();
  folded_ = true;
}

}  // namespace paperbake
