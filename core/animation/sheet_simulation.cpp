#include "core/animation/sheet_simulation.h"

#include "core/animation/branch_search.h"
#include "core/animation/expected_creases.h"
#include "core/animation/found_fold.h"
#include "core/animation/initial_sheet.h"
#include "core/animation/mesh_coarseness.h"
#include "core/animation/mesh_swap.h"
#include "core/animation/motion_measures.h"
#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/model/error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace paperbake {
namespace {

// [s] longest step with inertia: backward Euler damps motion, the more the longer the step
constexpr double max_inertial_step = 1 / 96.0;
constexpr int max_halvings_for_inertia = 8;
// [1] of what a sheet stored when a fold was last tried: while it stores as much to within this, no
// fold is tried again, because one has to save a tenth of it
constexpr double new_energy = 0.1;
constexpr double jammed_stretch = 0.01;  // [1] |l - L|/L of an edge
// [1] of the longer side: below motion_threshold no method changes the mesh, below sleep_threshold
// nothing is solved either
constexpr double motion_threshold = 2e-4, sleep_threshold = 1e-5;

/// Puts the held vertices of the start shape at their targets and returns true, unless one of them
/// is farther away than `same`. The first frame then shows the sheet as it was modelled: relaxing
/// it would lose a slight arch that tells it which way to buckle, and handles that lie a little
/// below such an arch are no reason to relax it.
bool in_place(Sheet& sheet, const PositionConstraints& constraints, double side) {
  const double same = 5e-4 * side;  // [m]
  for (const PositionConstraint& c : constraints)
    if ((sheet.x.row(c.vertex) - c.target.transpose()).norm() > same) return false;
  for (const PositionConstraint& c : constraints) sheet.x.row(c.vertex) = c.target;
  return true;
}

/// Sum of |dihedral angle| x length over the edges. [m rad]
double fold_integral(const Sheet& sheet) {
  double sum = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
    sum += std::abs(dihedral_angle(sheet.x, hinge)) *
           (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0])).norm();
  return sum;
}

/// The sheet as the method finishes it. The simulated one is kept when the finished one would
/// intersect itself more often or lie deeper inside a collider.
Sheet finished(const Method& method, const Sheet& sheet, const StepInput& input,
               const Elastic& elastic, const ElasticReport& step) {
  Sheet output_sheet = sheet;
  if (!method.finish(output_sheet, vertices_of(input.constraints))) return output_sheet;
  if (step.touching > 0 && crossings(output_sheet) > crossings(sheet)) return sheet;
  if (elastic.inside(output_sheet, input.colliders.to) > std::max(step.inside, 5e-5)) return sheet;
  return output_sheet;
}

/// True if the state belongs to a mesh with as many vertices and triangles as the sheet has.
bool is_of_mesh(const SolverState& p, const Sheet& sheet) {
  const auto there_are = [](const auto& m, Eigen::Index rows) {
    return m.rows() == 0 || m.rows() == rows;
  };
  const Eigen::Index vertices = sheet.x.rows(), triangles = sheet.triangles.rows();
  return std::all_of(p.positions.begin(), p.positions.end(),
                     [&](const Points3& x) { return there_are(x, vertices); }) &&
         (!p.second || there_are(p.second->x, vertices)) && there_are(p.ridges.share, triangles) &&
         there_are(p.ridges.focus, triangles);
}

bool is_of_mesh(const PositionConstraints& constraints, const Sheet& sheet) {
  return std::all_of(constraints.begin(), constraints.end(), [&](const PositionConstraint& c) {
    return c.vertex >= 0 && c.vertex < sheet.x.rows();
  });
}

/// A sentence on handles that give way although the sheet does not touch itself, because a collider
/// is in its way; empty: none does.
std::string note_of_yielding(const std::vector<HandleFrame>& handles) {
  int yielding = 0;
  double most = 0;
  for (const HandleFrame& handle : handles)
    if (handle.state == HandleFrame::jammed) {
      ++yielding;
      most = std::max(most, (handle.at - handle.keyed).norm());
    }
  if (yielding == 0) return "";
  char note[120];
  std::snprintf(note, sizeof note, "a collider is in the way: %d %s, by up to %.1f mm", yielding,
                yielding == 1 ? "handle gives way" : "handles give way", 1e3 * most);
  return note;
}

ElasticOptions options_of(const Shot& shot, const AnimateOptions& options) {
  ElasticOptions elastic = options.elastic;
  elastic.colliders = shot.colliders;
  return elastic;
}

}  // namespace

SheetSimulation::SheetSimulation(const Shot& shot, const MethodChoice& method,
                                 const AnimateOptions& options, const Place& place)
    : dhat(place.number, 0.0),
      shot_(shot),
      method_(method.make()),
      options_(options),
      number_(place.number),
      alone_(place.sheets == 1),
      side_(longer_side(shot.pattern)),
      started_(make_initial_sheet(shot, *method_, options.seed, options.first_frame)),
      elastic_(shot.paper, options_of(shot, options)),
      handles_(shot, started_.handle_vertex, options.first_frame),
      frame_(options.first_frame - 1) {
  if (options.plasticity == Plasticity::on)
    elastic_.set_plastic_grid(&plastic_grid_.emplace(shot.pattern));
  elastic_.set_mesh(started_.sheet, started_.stiffening);
  while (std::ldexp(1 / options.fps, -inertial_halvings_) > 1.001 * max_inertial_step &&
         inertial_halvings_ < max_halvings_for_inertia)
    ++inertial_halvings_;
  if (options.resume_state.empty()) return;
  Serializer kept(options.resume_state);
  archive(kept);
}

void SheetSimulation::archive(Serializer& a) {
  Sheet& sheet = started_.sheet;
  SolverState state = elastic_.state();
  a(frame_, sheet, output_sheet_, positions_before_, input_before_.constraints, at_minimum_,
    yielding_, yielded_, folded_, stored_unfolded_, started_.fixed, started_.has_bends,
    snap_in_progress_, rests_on_contact_, idle_frames_, swing_.amplitude, swing_.rate, quiet_,
    contact_, touching_, on_colliders_, state, handles_, dhat);
  archive_jam(a);
  if (plastic_grid_) a(*plastic_grid_);
  method_->archive(a);
  if (!a.reads()) return;
  a.end();
  const int row = frame_ - options_.first_frame;
  input_before_.time = row / options_.fps;
  const auto rows = sheet.x.rows();
  a.require(frame_ >= options_.first_frame && output_sheet_.x.rows() == rows &&
            (positions_before_.rows() == 0 || positions_before_.rows() == rows));
  a.require(is_of_mesh(input_before_.constraints, sheet) && is_of_mesh(state, sheet) &&
            dhat.size() == number_);
  a.require(std::all_of(started_.handle_vertex.begin(), started_.handle_vertex.end(),
                        [&](int v) { return v < rows; }));
  if (shot_.colliders) {
    input_before_.colliders = motion_to(*shot_.colliders, row);
    input_before_.colliders.from = input_before_.colliders.to;
  }
  a.require(swing_.rate >= 0 && std::isfinite(swing_.rate) && quiet_ >= 0 &&
            (swing_.rate == 0 || options_.release_inertia == ReleaseInertia::automatic));
  if (swing_.rate > 0) elastic_.set_inertia(Inertia::dynamic);
  elastic_.set_mesh(sheet, disc_factors(sheet, shot_));
  if (plastic_grid_) state.grid = *plastic_grid_;
  elastic_.restore(state);
}

void SheetSimulation::archive_jam(Serializer& a) {
  std::vector<Points3> places;
  for (const auto& collider : jammed_between_) places.push_back(collider->mesh().x);
  a(places);
  if (!a.reads() || places.empty()) return;
  a.require(shot_.colliders && places.size() == shot_.colliders->size());
  jammed_between_ = shapes_at(*shot_.colliders, frame_ - options_.first_frame);
  for (std::size_t c = 0; c < places.size(); ++c) {
    auto& shape = jammed_between_[c];
    a.require(places[c].rows() == shape->mesh().x.rows());
    if (places[c] != shape->mesh().x) shape = std::make_shared<const Collider>(*shape, places[c]);
  }
}

void SheetSimulation::move_world() {
  const int row = frame_ - options_.first_frame;
  input_ = {handles_.held(frame_)};
  input_.time = row / options_.fps;
  fold_by_hands(started_.sheet, shot_.hands, row);
  if (shot_.colliders) input_.colliders = motion_to(*shot_.colliders, row);
  if (!jammed_between_.empty()) input_.colliders.from = jammed_between_;
}

RemeshContext SheetSimulation::remesh_context(double share) const {
  const Sheet& sheet = started_.sheet;
  return {started_.fixed,
          plastic_grid_ ? &*plastic_grid_ : nullptr,
          isolated_moving_handles(sheet, input_.constraints, motion_threshold * side_,
                                  0.15 * shorter_side(shot_.pattern)),
          {frame_, 1 / options_.fps, max_motion_ / side_},
          max_motion_ > motion_threshold * side_,
          snap_in_progress_,
          at_minimum_,
          yielding_,
          rests_on_contact_,
          share * relative_motion_,
          share * rms_deformation(positions_before_, sheet.x) / side_,
          share * squeeze_,
          false,
          [this] { return elastic_.local_energies(started_.sheet); }};
}

void SheetSimulation::carry_state(const Sheet& before) {
  const Sheet& sheet = started_.sheet;
  SolverState known = elastic_.state();
  const MeshTransfer onto(before.pattern, before.triangles, sheet.pattern);
  for (Points3& x : known.positions) x = onto(x);
  if (positions_before_.rows() == before.x.rows()) positions_before_ = onto(positions_before_);
  if (known.second) known.second->x = onto(known.second->x);
  known.remeshed = true;
  known.ridges = {};
  elastic_.set_mesh(sheet, disc_factors(sheet, shot_));
  elastic_.restore(known);
}

void SheetSimulation::begin_carrying() {
  carried_.reset();
  is_carried_ = false;
  at_frame_before_ = input_before_;
  // a sheet that is on its way down moves when it is relaxed, whatever its mesh
  if (frame_ == options_.first_frame || contact_ || !(at_minimum_ || has_inertia())) return;
  carried_ = sheet();
}

void SheetSimulation::carry(const Points3& start) {
  constexpr double same = 0.03;  // [1] of the longer side: what goes farther is on another branch
  if (!carried_) return;
  Sheet carried = sheet();
  carried.x = start;
  carried_.reset();
  // its folds lie elsewhere on another mesh: halfway between both is no shape of paper
  if (method_->is_crumpled(carried)) return;
  if (!has_inertia()) {
    const SolverState known = elastic_.state();
    const ElasticReport settled =
        elastic_.relax(carried, at_frame_before_, 1 / options_.fps, Relaxation::full);
    elastic_.restore(known);
    if (!settled.converged || settled.contact || max_row_norm(carried.x - start) > same * side_)
      return;
  }
  carried_ = std::move(carried);
  is_carried_ = true;
}

void SheetSimulation::remesh(double share) { change_mesh(remesh_context(share)); }

bool SheetSimulation::change_mesh(const RemeshContext& is) {
  Sheet& sheet = started_.sheet;
  Sheet unchanged = sheet;
  before_remesh_.reset();
  was_at_minimum_ = at_minimum_;
  const MeshChange change = method_->remesh(sheet, is);
  if (change == MeshChange::none) return false;
  before_remesh_ = {std::move(unchanged), elastic_.state()};
  vertices_moved_ = change == MeshChange::moved;
  if (vertices_moved_)
    carry_state(before_remesh_->sheet);
  else
    elastic_.set_mesh(sheet, disc_factors(sheet, shot_));
  if (!cuts_into_collider(before_remesh_->sheet)) return true;
  undo_remesh();
  return false;
}

/// Whether the change of mesh has put an edge or a triangle into a collider: it would be stuck
/// there.
bool SheetSimulation::cuts_into_collider(const Sheet& before) const {
  constexpr double deepest = 2e-5;  // [m]
  if (on_colliders_ == 0) return false;
  const ColliderShapes now = followed_ > 0
                                 ? between(input_.colliders.from, input_.colliders.to, followed_)
                                 : input_.colliders.from;
  const double depth = elastic_.inside(sheet(), now);
  return depth > deepest && depth > elastic_.on_mesh(before).inside(before, now);
}

/// Not on the mesh of a sheet that begins tightly bent: it is fine enough to show its folds.
bool SheetSimulation::finds_folds() const {
  return !started_.has_bends && method_->finds_folds(sheet());
}

std::vector<FoldLine> SheetSimulation::fold_lines() const {
  if (!finds_folds() || !plastic_grid_ || !(yielded_ || on_colliders_ > 0)) return {};
  const auto memory = [&] {
    return plastic_grid_->read(plastic_grid_->cover(sheet().pattern, sheet().triangles));
  };
  std::vector<FoldLine> lines;
  if (yielded_) lines = method_->fold_lines(sheet(), memory());
  if (lines.empty() && on_colliders_ > 0)
    lines = method_->pressed_lines(sheet(), memory, input_before_.colliders.to);
  return lines;
}

void SheetSimulation::fold_if_bent(const AdmissibilityCheck& is_admissible) {
  Sheet& sheet = started_.sheet;
  const std::vector<FoldLine> lines = fold_lines();
  if (lines.empty()) return;
  const double stored = elastic_.evaluate_energies(sheet).energy;
  if (std::abs(stored - stored_unfolded_) < new_energy * stored_unfolded_) return;
  stored_unfolded_ = stored;
  const SolverState known = elastic_.state();
  const LoadStep now{input_before_, 1 / options_.fps, 0, frame_ - options_.first_frame, 0};
  std::optional<FoundFold> fold = fold_along(
      lines, {shot_, sheet, elastic_, *plastic_grid_, options_.first_frame, now, past_}, *method_);
  if (!fold) return;
  if (!is_admissible(sheet, fold->sheet, fold->moved)) {
    elastic_.restore(known);
    return;
  }
  carried_.reset();
  sheet = std::move(fold->sheet);
  elastic_ = std::move(fold->elastic);
  started_.fixed = std::move(fold->fixed);
  fold->step.substeps += step_.substeps;
  fold->step.iterations += step_.iterations;
  step_ = std::move(fold->step);
  positions_before_ = sheet.x;
  before_remesh_.reset();
  past_.clear();
  folded_ = true;
}

bool SheetSimulation::joins(LoadStep& last, const LoadStep& next) const {
  constexpr double longest = 0.15;  // [1] of an edge
  const double spacing = longest * mean_edge(sheet().pattern, sheet().triangles);
  const double way = std::max(farthest_move(last.input.colliders.from, next.input.colliders.to),
                              side_ * (last.relative_motion + next.relative_motion));
  if (way > spacing || last.halvings != next.halvings ||
      vertices_of(last.input.constraints) != vertices_of(next.input.constraints))
    return false;
  const ColliderShapes from = last.input.colliders.from;
  const double dt = last.dt + next.dt, motion = last.relative_motion + next.relative_motion;
  last = next;
  last.input.colliders.from = from;
  last.dt = dt;
  last.relative_motion = motion;
  return true;
}

void SheetSimulation::remember(int part) {
  constexpr std::size_t most = 8;
  if (!alone_ || !shot_.colliders || !plastic_grid_ || !finds_folds()) return;
  const LoadStep load{load_parts_ > 1 ? input_of_part(part) : input_,
                      1 / options_.fps / load_parts_, relative_motion_ / load_parts_,
                      frame_ - options_.first_frame, has_inertia() ? inertial_halvings_ : 0};
  if (!past_.empty() && joins(past_.back().load, load)) return;
  if (past_.size() == most) past_.erase(past_.begin());
  past_.push_back({sheet(), *plastic_grid_, load});
}

int SheetSimulation::parts_of_frame() const {
  constexpr int most = 16;
  if (!alone_ || frame_ == options_.first_frame) return 1;
  const int parts = method_->load_parts(sheet(), std::max(relative_motion_, squeeze_));
  if (!plastic_grid_ || !shot_.colliders || !sheet().prescribed_creases.empty() || !finds_folds())
    return parts;
  // [1] of the longer side: where handles go farther in a frame than they do in one step
  // (substepping.h), its parts are as long as a severe conflict has to last
  constexpr double fast = 0.03, slow = 0.0105;
  const double by_handles = relative_motion_ > fast ? relative_motion_ / slow : 1;
  return std::max(parts, std::clamp(static_cast<int>(std::ceil(by_handles)), 1, most));
}

void SheetSimulation::prepare(const AdmissibilityCheck& is_admissible) {
  Sheet& sheet = started_.sheet;
  result_ = {};
  step_ = {};
  result_.frame = ++frame_;
  begin_carrying();
  move_world();
  const bool first = frame_ == options_.first_frame;
  singular_before_ = sheet.singular.size();
  max_motion_ = max_displacement(sheet, input_, input_before_.constraints, positions_before_);
  idle_frames_ = max_motion_ < sleep_threshold * side_ ? idle_frames_ + 1 : 0;
  begin_trial();
  relative_motion_ =
      relative_handle_motion(sheet, input_.constraints, input_before_.constraints) / side_;
  followed_ = 0;
  squeeze_ = may_jam() && on_colliders_ > 0 ? squeeze(sheet.x, input_.colliders) / side_ : 0;
  load_parts_ = parts_of_frame();
  const RemeshContext situation = remesh_context(1.0 / load_parts_);
  // a sheet that has just been folded keeps its mesh: it is still coming to rest on it
  const bool keeps_mesh = first || std::exchange(folded_, false);
  if (!keeps_mesh)
    if (auto proposal = method_->propose(sheet, situation)) {
      std::vector<double> stiffening = disc_factors(*proposal, shot_);
      const MeshSwapResult verdict =
          try_swap_mesh(sheet, elastic_, {std::move(*proposal), std::move(stiffening)},
                        input_before_, 1 / options_.fps, is_admissible);
      method_->on_proposal_result(verdict.accepted, situation.now);
      result_.statistics.remesh =
          verdict.accepted ? FrameStatistics::accepted : FrameStatistics::rejected;
      result_.statistics.remesh_rise = verdict.rise;
      if (verdict.accepted) {
        started_.has_bends = false;
        carry(sheet.x);
      }
    }
  came_from_ = input_before_.constraints;
  input_before_ = input_;
  input_before_.colliders.from = input_.colliders.to;
  before_remesh_.reset();
  step_start_.reset();
  if (!keeps_mesh && result_.statistics.remesh != FrameStatistics::accepted) {
    remesh(1.0 / load_parts_);
    if (before_remesh_ && !is_admissible(before_remesh_->sheet, sheet, 0)) {
      restore(std::move(*before_remesh_));
      before_remesh_.reset();
    }
    if (before_remesh_) carry(sheet.x);
  }
  positions_before_ = sheet.x;
  is_sleeping_ = idle_frames_ >= 2 && !has_inertia();
  is_idle_ = is_sleeping_ || (first && in_place(sheet, input_.constraints, side_));
}

void SheetSimulation::restore(Snapshot&& back) {
  carried_.reset();
  Sheet& sheet = started_.sheet;
  sheet = std::move(back.sheet);
  elastic_.set_mesh(sheet, disc_factors(sheet, shot_));
  elastic_.restore(back.state);
}

void SheetSimulation::skip_step() {
  step_ = {};
  step_.last = elastic_.evaluate_energies(sheet());
  step_.last.contact = contact_;
  step_.last.touching = touching_;
  step_.last.on_colliders = on_colliders_;
  started_.sheet.v.setZero();
  trajectory_ = {{0, sheet().x}, {1, sheet().x}};
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

SubstepTarget SheetSimulation::substep_target(RecordTrajectory trace) {
  return {elastic_, started_.sheet,
          input_,   relative_motion_,
          side_,    trace == RecordTrajectory::yes ? &trajectory_ : nullptr,
          {},       may_jam()};
}

bool SheetSimulation::may_jam() const {
  return alone_ && shot_.colliders && !has_inertia() && input_.constraints.empty();
}

FrameInterval SheetSimulation::frame_interval(const Eigen::MatrixXd& between) const {
  return {"frame " + std::to_string(frame_) + " of " + std::to_string(options_.last_frame),
          1 / options_.fps,
          has_inertia()              ? inertial_halvings_
          : !jammed_between_.empty() ? halvings_of_squeeze(input_.colliders)
                                     : 0,
          between};
}

bool SheetSimulation::is_locked() const {
  if (!before_remesh_ || !step_.last.contact || step_.converged) return false;
  return (vertices_moved_ && (was_at_minimum_ || squeeze_ == 0)) ||
         length_distortion(sheet()).largest >
             std::max(jammed_stretch, 4 * length_distortion(before_remesh_->sheet).largest);
}

void SheetSimulation::undo_remesh() {
  restore(std::move(*before_remesh_));
  before_remesh_.reset();
  positions_before_ = sheet().x;
}

void SheetSimulation::begin_step(RecordTrajectory trace) {
  if (trace == RecordTrajectory::yes || on_trial_) step_start_ = {sheet(), elastic_.state()};
  if (trace == RecordTrajectory::yes) trajectory_ = {{0, sheet().x}};
}

void SheetSimulation::roll_back() {
  if (!step_start_) return;
  started_.sheet = step_start_->sheet;
  elastic_.restore(step_start_->state);
}

double SheetSimulation::fastest_hand(int frame) const {
  const int row = frame - options_.first_frame;
  if (row < 1) return 0;
  double most = farthest_target_move(handles_.held(frame - 1), handles_.held(frame));
  if (shot_.colliders) {
    const ColliderMotion moving = motion_to(*shot_.colliders, row);
    most = std::max(most, farthest_move(moving.from, moving.to));
  }
  return most * options_.fps;
}

void SheetSimulation::begin_trial() {
  on_trial_ = false;
  if (options_.release_inertia == ReleaseInertia::off || frame_ == options_.first_frame) return;
  if (!has_inertia()) {
    on_trial_ = lets_go(input_before_.constraints, input_.constraints);
    if (on_trial_) potential_at_start_ = elastic_.evaluate_energies(sheet()).potential;
  } else if (swing_.rate > 0 && quiet_ >= quarter_period(swing_)) {
    on_trial_ = true;
    elastic_.set_inertia(Inertia::quasi_static);
  }
}

/// The swing about the equilibrium that the step on trial leads to. On the way down from an
/// unstable shape that takes several steps, which leave no trace.
Swing SheetSimulation::swing_on_trial() {
  constexpr int max_steps = 8;
  Sheet& sheet = started_.sheet;
  const Snapshot now{sheet, elastic_.state()};
  ElasticReport last = step_.last;
  bool arrived = step_.converged && !last.snap_in_progress;
  for (int k = 0; k < max_steps && !arrived; ++k) try {
      last = elastic_.step(sheet, input_before_, 1 / options_.fps);
      arrived = last.converged && !last.snap_in_progress;
    } catch (const Error&) {  // the energy is not finite
      break;
    }
  Swing swing = swing_to(sheet, step_start_->sheet.x, vertices_of(input_.constraints),
                         potential_at_start_ - last.potential, shot_.paper.area_density);
  sheet = now.sheet;
  elastic_.restore(now.state);
  // on the first part of its way a sheet frees its energy faster: it may be a slow swing
  if (!arrived) swing.rate = std::min(swing.rate, 0.5 * fastest_swing);
  return swing;
}

bool SheetSimulation::fails_trial() {
  if (!on_trial_) return false;
  on_trial_ = false;
  const Sheet& start = step_start_->sheet;
  const bool was_let_go = swing_.rate > 0;
  if (was_let_go) {
    const Points3 left = sheet().x - start.x - start.v / options_.fps;
    if (step_.converged && max_row_norm(left) <= still(side_)) {
      swing_ = {};
      add_note("it has come to rest and goes on without inertia");
      return false;
    }
  } else {
    if (!step_.failure_reason.empty()) return false;
    const Swing swing = swing_on_trial();
    if (!needs_inertia(swing, side_)) return false;
    swing_ = swing;
    // A sheet at equilibrium is moved by its hands and goes no faster than they do, whatever its
    // last step was.
    Points3& v = step_start_->sheet.v;
    const double fastest = max_row_norm(v), hand = fastest_hand(frame_ - 1);
    if (fastest > hand) v *= hand / fastest;
    char note[120];
    std::snprintf(note, sizeof note, "let go, it springs by %.1f mm: it moves with inertia now",
                  1e3 * swing.amplitude);
    add_note(note);
  }
  quiet_ = 0;
  elastic_.set_inertia(Inertia::dynamic);
  return true;
}

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

void SheetSimulation::step_part(RecordTrajectory trace, int part) {
  const auto take_step = [&] {
    begin_step(trace);
    SubstepTarget target = substep_target(trace);
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
  if (!fails_trial()) return;
  roll_back();
  take_unlocked_step();
}

bool SheetSimulation::is_held_back_by_mesh() const {
  return step_.failure_reason.empty() && step_.last.on_colliders > 0 && is_smooth() &&
         mean_square_fold(sheet()) > coarse;
}

bool SheetSimulation::is_smooth() const {
  return !started_.has_bends && sheet().singular.empty() && sheet().prescribed_creases.empty();
}

bool SheetSimulation::refine_mesh(Snapshot&& begun) {
  std::optional<Method::FirstMesh> finer = method_->finer_mesh();
  if (!finer) return false;
  const Sheet before = begun.sheet;
  restore(std::move(begun));
  Sheet& sheet = started_.sheet;
  const MeshTransfer onto(before.pattern, before.triangles, finer->pattern);
  sheet.x = onto(before.x);
  sheet.v = onto(before.v);
  sheet.pattern = std::move(finer->pattern);
  sheet.triangles = std::move(finer->triangles);
  started_.fixed.assign(sheet.pattern.rows(), 0);
  for (const int v : finer->point_vertex) started_.fixed[v] = 1;
  carry_state(before);
  before_remesh_.reset();
  past_.clear();
  step_ = {};
  return true;
}

void SheetSimulation::step(RecordTrajectory trace) {
  const bool may_refine = alone_ && shot_.colliders && has_inertia() && is_smooth();
  for (;;) {
    std::optional<Snapshot> begun;
    if (may_refine) begun = {sheet(), elastic_.state()};
    step_in_parts(trace);
    if (!may_refine || !is_held_back_by_mesh() || !refine_mesh(std::move(*begun))) break;
  }
  hold_if_infeasible();
  hold_if_jammed();
}

bool SheetSimulation::refine_jammed_smooth_mesh() {
  const Snapshot kept{sheet(), elastic_.state()};
  const std::vector<char> fixed = started_.fixed;
  const FrameStepResult jammed = step_;
  const ColliderShapes now = between(input_.colliders.from, input_.colliders.to, followed_);
  const double depth = elastic_.inside(sheet(), now);
  if (!refine_mesh(Snapshot(kept))) return false;
  step_ = jammed;
  if (crossings(sheet()) == 0 && elastic_.inside(sheet(), now) <= std::max(depth, yield_depth))
    return true;
  restore(Snapshot(kept));
  started_.fixed = fixed;
  return false;
}

bool SheetSimulation::refine_where_jammed() {
  if (is_smooth()) return refine_jammed_smooth_mesh();
  RemeshContext is = remesh_context(1);
  is.jammed = true;
  return change_mesh(is);
}

bool SheetSimulation::settle() {
  constexpr double pressed_less = 0.95;  // [1] of the largest stretch of an edge
  const double before = length_distortion(sheet()).largest;
  const Snapshot begun{sheet(), elastic_.state()};
  SubstepTarget target = substep_target(RecordTrajectory::no);
  ColliderMotion& at = target.input.colliders;
  at.from = at.to = between(at.from, at.to, followed_);
  FrameInterval interval = frame_interval({});
  interval.min_halvings = 0;
  const FrameStepResult rest = advance_frame({target}, interval).front();
  const double after = length_distortion(sheet()).largest;
  if (!rest.failure_reason.empty() || after > before || rest.last.inside > yield_depth) {
    restore(Snapshot(begun));
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
  const ColliderShapes where = std::exchange(jammed_between_, {});
  if (step_.followed == 1 || !step_.failure_reason.empty()) return;
  const ColliderMotion& moving = input_.colliders;
  jammed_between_ = between(moving.from, moving.to, followed_);
  if (followed_ == 0) {
    jammed_between_ = moving.from;
    const FrameStepResult tried = step_;
    skip_step();
    step_.iterations = tried.iterations;
    step_.converged = false;
  }
  char note[120];
  std::snprintf(note, sizeof note, "it is jammed: colliders have gone on by %.1f mm without it",
                1e3 * farthest_move(jammed_between_, moving.to));
  add_note(note);
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
    at_minimum_ = step_.converged && !step_.last.snap_in_progress;
    step_.last.plastic_increment += before.last.plastic_increment;
    followed_ += step_.followed * (double(part) / load_parts_ - followed_);
    if (step_.followed < 1) {
      const bool finer = refinements++ < most_refinements && refine_where_jammed();
      const bool stays = !finer && followed_ == 0 && !jammed_between_.empty();
      if (refinements > most_refinements || stays) return;
      if (!settle() && !finer) return;
      --part;
    } else if (part < load_parts_) {
      followed_ = double(part) / load_parts_;
      note_contact();
      fold_if_bent([](const Sheet&, const Sheet&, double) { return true; });
    }
  }
}

Points3 SheetSimulation::initial_positions() const {
  return MeshTransfer(shot_.start.pattern, shot_.start.triangles, sheet().pattern)(shot_.start.x);
}

void SheetSimulation::step_together(const std::vector<SheetSimulation*>& all,
                                    const Eigen::MatrixXd& dhat, InitialGap initial_positions) {
  const auto take_step = [&] {
    std::vector<SubstepTarget> followers;
    FrameInterval interval = all.front()->frame_interval(dhat);
    for (SheetSimulation* a : all) {
      a->is_idle_ = a->is_sleeping_ = false;
      a->begin_step(RecordTrajectory::yes);
      followers.push_back(a->substep_target(RecordTrajectory::yes));
      if (initial_positions == InitialGap::within_dhat)
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
  if (std::count_if(all.begin(), all.end(), [](SheetSimulation* a) { return a->fails_trial(); }))
    take_unlocked_step();
  for (SheetSimulation* a : all) a->hold_if_infeasible();
}

void SheetSimulation::note_contact() {
  snap_in_progress_ = step_.last.snap_in_progress;
  contact_ = step_.last.contact;
  touching_ = step_.last.touching;
  on_colliders_ = step_.last.on_colliders;
  rests_on_contact_ = step_.last.on_colliders > 0 || touches_others();
  at_minimum_ = step_.converged && !snap_in_progress_;
  yielded_ = step_.last.plastic_increment > 0;
}

void SheetSimulation::finish_step(const AdmissibilityCheck& is_admissible) {
  constexpr double min_plastic_increment = 0.01;  // [1] of the fold integral, in one frame
  result_.statistics.new_singular = static_cast<int>(sheet().singular.size() - singular_before_);
  note_contact();
  if (!is_idle_) fold_if_bent(is_admissible);
  note_contact();
  yielding_ = step_.last.plastic_increment > 0 &&
              step_.last.plastic_increment > min_plastic_increment * fold_integral(sheet());
  if (step_.last.energy_gain > 1e-3)
    add_note("snap: a second start ended " +
             std::to_string(static_cast<int>(std::lround(100 * step_.last.energy_gain))) +
             " % lower in energy and was taken");
  if (swing_.rate > 0) {
    double fastest = max_row_norm(sheet().v);
    if (positions_before_.rows() == sheet().x.rows())
      fastest = std::max(fastest, options_.fps * max_row_norm(sheet().x - positions_before_));
    const double allowed = still(side_) * swing_.rate + fastest_hand(frame_);
    quiet_ = fastest <= allowed ? quiet_ + 1 / options_.fps : 0;
  }
  if (options_.probe_every > 0 && !is_sleeping_ && !touches_others() && !has_inertia() &&
      (frame_ - options_.first_frame + 1) % options_.probe_every == 0)
    probe(is_admissible);
  handles_.bind_relative_handles(sheet().x, frame_);
}

void SheetSimulation::probe(const AdmissibilityCheck& is_admissible) {
  Snapshot as_it_was{sheet(), elastic_.state()};
  const BranchSearch found = probe_branches(started_.sheet, elastic_, input_before_,
                                            {1 / options_.fps, options_.seed, frame_});
  if (found.taken || found.finished) {
    if (!is_admissible(as_it_was.sheet, sheet(),
                       (sheet().x - as_it_was.sheet.x).rowwise().norm().maxCoeff()))
      return restore(std::move(as_it_was));
    const ElasticReport stored = elastic_.evaluate_energies(sheet());
    step_.last.energy = stored.energy;
    step_.last.membrane = stored.membrane;
  }
  add_note(note_of(found));
}

void SheetSimulation::add_note(const std::string& note) {
  if (!note.empty()) result_.note += (result_.note.empty() ? "" : "; ") + note;
}

void SheetSimulation::finalize(Output how) {
  if (is_sleeping_ && frame_ != options_.first_frame) return;
  output_sheet_ = how == Output::simulated_sheet
                      ? sheet()
                      : finished(*method_, sheet(), input_, elastic_, step_.last);
  inside_ = elastic_.inside(output_sheet_, input_.colliders.to);
}

AnimatedFrame SheetSimulation::report() {
  AnimatedFrame result = std::move(result_);
  result.sheet_index = number_;
  result.sheet = &output_sheet_;
  result.parts = method_->parts(sheet());
  // within the step, the mesh may have changed once more
  if (is_carried_ && carried_ && carried_->triangles == sheet().triangles &&
      carried_->pattern == sheet().pattern) {
    method_->finish(*carried_, vertices_of(at_frame_before_.constraints));
    result.carried = carried_->x;
  }
  result.handles = handles_.report(output_sheet_.x, frame_);
  if (on_colliders_ > 0 && touching_ == 0)
    if (const std::string note = note_of_yielding(result.handles); !note.empty())
      result.note += (result.note.empty() ? "" : "; ") + note;
  FrameStatistics& statistics = result.statistics;
  statistics.inertia = has_inertia();
  statistics.substeps = step_.substeps;
  statistics.newton_iterations = step_.iterations;
  statistics.converged = step_.converged;
  statistics.energy = step_.last.energy;
  statistics.membrane_energy = step_.last.membrane;
  statistics.contact = step_.last.contact;
  statistics.touching = step_.last.touching;
  statistics.touching_others = step_.last.touching_others;
  statistics.on_colliders = step_.last.on_colliders;
  statistics.inside_colliders = inside_;
  statistics.plastic = plastic_grid_ ? plastic_grid_->integral() : 0;
  result.plastic_grid = plastic_grid_ ? &*plastic_grid_ : nullptr;
  if (plastic_grid_ && options_.report_plastic_curvature)
    result.plastic_curvature =
        plastic_grid_->at_vertices(output_sheet_.pattern, output_sheet_.triangles);
  result.state = [this] {
    Serializer now;
    archive(now);
    return now.bytes();
  };
  return result;
}

}  // namespace paperbake
