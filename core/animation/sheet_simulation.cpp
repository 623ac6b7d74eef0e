#include "core/animation/sheet_simulation.h"

#include "core/animation/branch_search.h"
#include "core/animation/flutter.h"
#include "core/animation/motion_measures.h"
#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/geometry/pattern_mesh.h"
#include "core/hands/folding_hands.h"
#include "core/model/formatted.h"
#include "core/step2_crumple/crumple.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace paperbake {
namespace {

// [s] longest step with inertia: backward Euler damps motion, the more the longer the step
constexpr double max_inertial_step = 1 / 96.0;
// [1] of the longer side: with less motion than this nothing is solved
constexpr double sleep_threshold = 1e-5;

/// Puts the held vertices of the start shape at their targets and returns true, unless one of them
/// is farther away than `near`. The first frame then shows the sheet as it was modelled: relaxing
/// it would lose a slight arch that tells it which way to buckle, and handles that lie a little
/// below such an arch are no reason to relax it.
bool move_to_near_targets(Sheet& sheet, const PositionConstraints& constraints, double side) {
  const double near = 5e-4 * side;  // [m]
  for (const PositionConstraint& c : constraints)
    if ((sheet.x.row(c.vertex) - c.target.transpose()).norm() > near) return false;
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

/// Lets the method finish a sheet. It stays as it is when the finished one would intersect itself
/// more often or lie deeper inside a collider.
/// returns  [m] how deep it lies in one then
double finish(const Method& method, Sheet& sheet, const StepInput& input, const Elastic& elastic,
              const ElasticReport& step) {
  const auto inside = [&](const Sheet& any) { return elastic.inside(any, input.colliders.to); };
  const auto adds_crossings = [&](const Sheet& finished) {
    const CrossingCounter crossings_at(sheet.pattern, sheet.triangles);
    return crossings_at(finished.x) > crossings_at(sheet.x);
  };
  Sheet finished = sheet;
  if (!method.finish(finished, vertices_of(input.constraints)) ||
      (step.touching > 0 && adds_crossings(finished)))
    return inside(sheet);
  const double depth = inside(finished);
  if (depth > std::max(step.inside, tolerated_depth)) return inside(sheet);
  sheet = std::move(finished);
  return depth;
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

/// A sentence on handles that give way while the sheet touches a collider, and not itself; empty:
/// none does.
std::string note_of_jammed(const std::vector<HandleFrame>& handles) {
  int jammed = 0;
  double most = 0;
  for (const HandleFrame& handle : handles)
    if (handle.state == HandleFrame::jammed) {
      ++jammed;
      most = std::max(most, (handle.at - handle.keyed).norm());
    }
  if (jammed == 0) return "";
  return formatted("it touches a collider, and %d %s, by up to %.1f mm", jammed,
                   jammed == 1 ? "handle gives way" : "handles give way", 1e3 * most);
}

/// The initial sheet. Its first mesh has at least so many times more triangles than the method
/// would choose, and is fine enough for a flag to wave, unless that asks for more than
/// doublings_to_bend.
InitialSheet start_on(const Shot& shot, Method& method, const AnimateOptions& options,
                      int doublings) {
  InitialSheet start = make_initial_sheet(shot, method, options.seed, options.first_frame);
  const bool has_inertia = options.elastic.inertia == Inertia::dynamic;
  const double longest = has_inertia
                             ? longest_edge_of_flag(shot, options.elastic.air, options.first_frame)
                             : std::numeric_limits<double>::infinity();
  const auto is_too_coarse = [&] {
    const int done = method.doublings();
    if (done < doublings) return true;
    const auto triangles = static_cast<int>(start.sheet.triangles.rows());
    return done < doublings_to_bend && equilateral_edge(shot.pattern, triangles) > longest;
  };
  while (is_too_coarse() && method.has_finer_mesh()) {
    method.finer_mesh();
    start = make_initial_sheet(shot, method, options.seed, options.first_frame);
  }
  return start;
}

}  // namespace

SheetSimulation::SheetSimulation(const Shot& shot, const MethodChoice& method,
                                 const AnimateOptions& options, const Place& place)
    : dhat(place.number, 0.0),
      shot_(shot),
      method_(method.make()),
      options_(options),
      number_(place.number),
      rehearsed_doublings_(place.rehearsal.doublings),
      lacks_triangles_(place.rehearsal.lacks_triangles),
      keys_until_(place.rehearsal.last_frame),
      simulated_(shot, start_on(shot, *method_, options, rehearsed_doublings_), options, number_),
      handles_(shot, simulated_.handle_vertex, options.first_frame),
      release_(options.fps, options.elastic.forces.gravity),
      folds_(simulated_, *method_, options.first_frame),
      frame_(options.first_frame - 1) {
  constexpr double rounding = 1.001;
  while (std::ldexp(1 / options.fps, -inertial_halvings_) > rounding * max_inertial_step &&
         inertial_halvings_ < max_halvings_for_inertia)
    ++inertial_halvings_;
  if (options.resume_state.empty()) return;
  Serializer kept(options.resume_state);
  archive(kept);
  // within a frame the mesh may be another one already
  kept.require(output_sheet_.x.rows() == sheet().x.rows());
}

void SheetSimulation::archive(Serializer& a) {
  Sheet& sheet = simulated_.sheet;
  SolverState state = simulated_.elastic.state();
  a(frame_, sheet, output_sheet_, simulated_.positions_before, resting_input_.constraints, outcome_,
    yielding_, folded_, joined_, simulated_.fixed, simulated_.has_bends, idle_frames_, state,
    handles_, dhat, keys_until_);
  release_.archive(a);
  jam_.archive(a, shot_.colliders.get());
  if (simulated_.plastic_grid) a(*simulated_.plastic_grid);
  folds_.archive(a);
  mesh_check_.archive(a);
  method_->archive(a);
  if (!a.reads()) return;
  a.end();
  const int row = frame_ - options_.first_frame;
  resting_input_.time = row / options_.fps;
  const auto rows = sheet.x.rows();
  a.require(frame_ >= options_.first_frame && (simulated_.positions_before.rows() == 0 ||
                                               simulated_.positions_before.rows() == rows));
  a.require(is_of_mesh(resting_input_.constraints, sheet) && is_of_mesh(state, sheet) &&
            dhat.size() == number_);
  a.require(std::all_of(simulated_.handle_vertex.begin(), simulated_.handle_vertex.end(),
                        [&](int v) { return v < rows; }));
  if (shot_.colliders) {
    resting_input_.colliders = motion_to(*shot_.colliders, row);
    resting_input_.colliders.from = resting_input_.colliders.to;
  }
  a.require(!release_.was_let_go() || options_.release_inertia == ReleaseInertia::automatic);
  if (release_.was_let_go()) release_.give_inertia(simulated_);
  simulated_.update_solver();
  if (simulated_.plastic_grid) state.grid = *simulated_.plastic_grid;
  simulated_.elastic.restore(state);
}

void SheetSimulation::move_world() {
  const int row = frame_ - options_.first_frame;
  now_.input = {handles_.held(frame_)};
  now_.input.time = row / options_.fps;
  fold_by_hands(simulated_.sheet, shot_.hands, row);
  if (shot_.colliders) {
    const ColliderShapes& before = resting_input_.colliders.to;
    now_.input.colliders = before.empty() ? motion_to(*shot_.colliders, row)
                                          : motion_to(*shot_.colliders, row, before);
  }
  jam_.begin_frame(now_.input.colliders);
}

void SheetSimulation::remember(int part) {
  if (!shot_.colliders || !folds_.is_on()) return;
  folds_.remember({now_.load_parts > 1 ? input_of_part(part) : now_.input,
                   1 / options_.fps / now_.load_parts, now_.relative_motion / now_.load_parts,
                   frame_ - options_.first_frame,
                   simulated_.has_inertia() ? halvings_of_part() : 0});
}

int SheetSimulation::halvings_of_part() const {
  int halvings = inertial_halvings_;
  for (int parts = now_.load_parts; parts > 1 && halvings > 0; parts /= 2) --halvings;
  return halvings;
}

int SheetSimulation::parts_of_frame() const {
  if (frame_ == options_.first_frame) return 1;
  const int parts = method_->load_parts(sheet(), std::max(now_.relative_motion, now_.squeeze));
  if (joined_ || !shot_.colliders || !sheet().prescribed_creases.empty() || !folds_.is_on())
    return parts;
  // where handles go farther in a frame than they do in one step, its parts are as long as a severe
  // conflict has to last
  const double by_handles =
      now_.relative_motion > max_handle_motion ? now_.relative_motion / severe_persistence : 1;
  return std::max(parts, std::clamp(static_cast<int>(std::ceil(by_handles)), 1, most_load_parts));
}

void SheetSimulation::prepare(const AdmissibilityCheck& is_admissible) {
  Sheet& sheet = simulated_.sheet;
  now_ = {};
  now_.result.frame = ++frame_;
  const bool first = frame_ == options_.first_frame;
  carried_.forget();
  // a sheet that is on its way down moves when it is relaxed, whatever its mesh
  if (!first && !outcome_.contact && (outcome_.at_minimum || simulated_.has_inertia()))
    carried_.begin(sheet, resting_input_);
  move_world();
  if (first && method_->doublings() > 0)
    add_note("it begins with " + std::to_string(1 << method_->doublings()) +
             " times as many triangles: " +
             (rehearsed_doublings_ > 0 ? "in a rehearsal a coarser mesh held it back"
                                       : "on fewer a flag waves less"));
  if (first && lacks_triangles_)
    add_note(
        "in a rehearsal it did not bend on the finest first mesh that it may have: "
        "allow it more triangles");
  now_.singular_before = sheet.singular.size();
  now_.max_motion =
      max_displacement(sheet, now_.input, resting_input_.constraints, simulated_.positions_before);
  idle_frames_ = now_.max_motion < sleep_threshold * simulated_.side ? idle_frames_ + 1 : 0;
  begin_trial();
  now_.relative_motion =
      relative_handle_motion(sheet, now_.input.constraints, resting_input_.constraints) /
      simulated_.side;
  now_.squeeze = now_.input.constraints.empty() && outcome_.on_colliders > 0
                     ? squeeze(sheet.x, now_.input.colliders) / simulated_.side
                     : 0;
  now_.load_parts = parts_of_frame();
  const RemeshContext context = remesh_context(1.0 / now_.load_parts);
  // a sheet that has just been folded keeps its mesh: it is still coming to rest on it
  const bool keeps_mesh = first || std::exchange(folded_, false);
  if (!keeps_mesh) try_proposal(context, is_admissible);
  now_.came_from = resting_input_.constraints;
  resting_input_ = now_.input;
  resting_input_.colliders.from = now_.input.colliders.to;
  if (!keeps_mesh && now_.result.statistics.remesh != FrameStatistics::accepted) {
    change_mesh(context, is_admissible);
    if (now_.last_remesh) carried_.carry(simulated_, *method_, sheet.x, 1 / options_.fps);
  }
  simulated_.positions_before = sheet.x;
  // the frame begins where it is, also on the mesh that it may have to go back to
  if (now_.last_remesh) {
    SimulatedSheet::MeshSnapshot& before = now_.last_remesh->before;
    before.positions_before = before.sheet.x;
  }
  now_.is_sleeping = comes_to_rest();
  now_.is_idle = now_.is_sleeping;
  if (first && !now_.is_idle)
    now_.is_idle = move_to_near_targets(sheet, now_.input.constraints, simulated_.side);
}

bool SheetSimulation::comes_to_rest() const {
  constexpr int frames = 2;
  if (!simulated_.has_inertia()) return idle_frames_ >= frames;
  // A sheet with inertia is slow, too, where a swing turns back, and where it stands in a balance
  // that it is about to lose: there nothing but its weight decides. And one whose steps are not
  // solved may stand in the air.
  constexpr int frames_with_inertia = 6;
  return idle_frames_ >= frames_with_inertia && outcome_.rests_on_contact && outcome_.at_minimum &&
         options_.elastic.air.winds.empty();
}

void SheetSimulation::restore(const SimulatedSheet::MeshSnapshot& back) {
  carried_.forget();
  simulated_.restore(back);
}

void SheetSimulation::skip_step() {
  now_.step = {};
  now_.step.last = simulated_.elastic.evaluate_energies(sheet());
  now_.step.last.contact = outcome_.contact;
  now_.step.last.touching = outcome_.touching;
  now_.step.last.on_colliders = outcome_.on_colliders;
  simulated_.sheet.v.setZero();
  now_.trajectory.begin(sheet());
  now_.trajectory.end(sheet());
}

double SheetSimulation::fastest_drive(int frame) const {
  const int row = frame - options_.first_frame;
  if (row < 1) return 0;
  double most = farthest_target_move(handles_.held(frame - 1), handles_.held(frame));
  if (shot_.colliders) most = std::max(most, farthest_move(*shot_.colliders, row));
  return most * options_.fps;
}

void SheetSimulation::begin_trial() {
  using LetGo = ReleaseTrial::LetGo;
  if (options_.release_inertia == ReleaseInertia::off || frame_ == options_.first_frame)
    return release_.skip();
  const bool has_weight = options_.elastic.forces.gravity != 0;
  release_.begin(simulated_, lets_go(resting_input_.constraints, now_.input.constraints)
                                 ? LetGo::by_handles
                             : !has_weight                        ? LetGo::no
                             : frame_ == options_.first_frame + 1 ? LetGo::as_modelled
                                                                  : LetGo::by_balance);
}

bool SheetSimulation::end_trial() {
  if (!release_.is_on()) return false;
  const ReleaseTrial::Verdict verdict =
      release_.end(simulated_, *now_.step_start, now_.step, resting_input_,
                   [this](int frames_ago) { return fastest_drive(frame_ - frames_ago); });
  add_note(verdict.note);
  return verdict.needs_inertia;
}

void SheetSimulation::note_outcome() {
  const ElasticReport& last = now_.step.last;
  outcome_.at_minimum = now_.step.converged && !last.snap_in_progress;
  outcome_.snap_in_progress = last.snap_in_progress;
  outcome_.contact = last.contact;
  // a sheet that is asleep lies where it fell asleep
  if (!now_.is_idle) outcome_.rests_on_contact = last.on_colliders > 0 || touches_others();
  outcome_.yielded = last.plastic_increment > 0;
  outcome_.touching = last.touching;
  outcome_.on_colliders = last.on_colliders;
}

void SheetSimulation::finish_step(const AdmissibilityCheck& is_admissible) {
  constexpr double min_plastic_increment = 0.01;  // [1] of the fold integral, in one frame
  constexpr double worth_a_note = 1e-3;           // [1] of the potential
  now_.result.statistics.new_singular =
      static_cast<int>(sheet().singular.size() - now_.singular_before);
  note_outcome();
  if (!now_.is_idle) fold_if_bent(is_admissible);
  note_outcome();
  if (options_.checks_mesh && doublings() == 0 && !now_.is_idle) check_mesh();
  yielding_ = now_.step.last.plastic_increment > 0 &&
              now_.step.last.plastic_increment > min_plastic_increment * fold_integral(sheet());
  if (now_.step.last.energy_gain > worth_a_note)
    add_note("snap: a second start ended " +
             std::to_string(static_cast<int>(std::lround(100 * now_.step.last.energy_gain))) +
             " % lower in energy and was taken");
  if (release_.was_let_go()) release_.observe(simulated_, now_.input, fastest_drive(frame_));
  if (options_.probe_every > 0 && !now_.is_sleeping && !touches_others() &&
      !simulated_.has_inertia() && (frame_ - options_.first_frame + 1) % options_.probe_every == 0)
    probe(is_admissible);
  handles_.bind_relative_handles(sheet().x, frame_);
}

void SheetSimulation::check_mesh() {
  const bool is_free = !outcome_.contact && outcome_.on_colliders == 0 && !touches_others();
  mesh_check_.look(simulated_, *method_, resting_input_,
                   rms_deformation(simulated_.positions_before, sheet().x) / simulated_.side,
                   outcome_.at_minimum && is_free && !simulated_.has_inertia());
}

void SheetSimulation::probe(const AdmissibilityCheck& is_admissible) {
  const SimulatedSheet::MeshSnapshot as_it_was = simulated_.snapshot();
  const BranchSearch found = probe_branches(simulated_.sheet, simulated_.elastic, resting_input_,
                                            {1 / options_.fps, options_.seed, frame_});
  if (found.taken || found.finished) {
    if (!is_admissible(as_it_was.sheet, sheet(), max_row_norm(sheet().x - as_it_was.sheet.x)))
      return restore(as_it_was);
    const ElasticReport stored = simulated_.elastic.evaluate_energies(sheet());
    now_.step.last.energy = stored.energy;
    now_.step.last.membrane = stored.membrane;
  }
  add_note(note_of(found));
}

void SheetSimulation::add_note(const std::string& note) { append_note(now_.result.note, note); }

void SheetSimulation::finalize(Output how) {
  if (now_.is_sleeping && frame_ != options_.first_frame) return;
  output_sheet_ = sheet();
  inside_ = how == Output::simulated_sheet
                ? simulated_.elastic.inside(output_sheet_, now_.input.colliders.to)
                : finish(*method_, output_sheet_, now_.input, simulated_.elastic, now_.step.last);
}

int SheetSimulation::keys_until() const {
  int last = std::max(frame_, keys_until_);
  if (folds_.has_looked_ahead())
    for (const Handle& handle : shot_.handles)
      last = std::max(last, options_.first_frame + static_cast<int>(handle.keyed.rows()) - 1);
  return last;
}

AnimatedFrame SheetSimulation::report() {
  AnimatedFrame result = std::move(now_.result);
  result.sheet_index = number_;
  result.keys_until = keys_until();
  result.sheet = &output_sheet_;
  result.parts = method_->parts(sheet());
  result.carried = carried_.positions(sheet(), *method_);
  result.handles = handles_.report(output_sheet_.x, frame_);
  if (outcome_.on_colliders > 0 && outcome_.touching == 0)
    append_note(result.note, note_of_jammed(result.handles));
  FrameStatistics& statistics = result.statistics;
  statistics.inertia = simulated_.has_inertia();
  statistics.substeps = now_.step.substeps;
  statistics.newton_iterations = now_.step.iterations;
  statistics.converged = now_.step.converged;
  statistics.energy = now_.step.last.energy;
  statistics.membrane_energy = now_.step.last.membrane;
  statistics.contact = now_.step.last.contact;
  statistics.doublings = doublings();
  statistics.mesh_error = mesh_check_.error();
  statistics.touching = now_.step.last.touching;
  statistics.touching_others = now_.step.last.touching_others;
  statistics.on_colliders = now_.step.last.on_colliders;
  statistics.inside_colliders = inside_;
  statistics.plastic = simulated_.plastic_grid ? simulated_.plastic_grid->integral() : 0;
  result.plastic_grid = simulated_.plastic_grid ? &*simulated_.plastic_grid : nullptr;
  if (simulated_.plastic_grid && options_.report_plastic_curvature)
    result.plastic_curvature =
        simulated_.plastic_grid->at_vertices(output_sheet_.pattern, output_sheet_.triangles);
  result.state = [this] {
    Serializer now;
    archive(now);
    return now.bytes();
  };
  return result;
}

}  // namespace paperbake
