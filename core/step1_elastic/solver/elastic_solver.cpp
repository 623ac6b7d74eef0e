#include "core/step1_elastic/solver/elastic_solver_impl.h"

#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/geometry/rigid_motion.h"
#include "core/step1_elastic/energy_not_finite.h"

#include <cmath>
#include <limits>

namespace paperbake {
namespace {

// fraction of the true mass; values from 1 to 1e-5 give the same shapes to 4 digits
constexpr double quasi_static_mass = 0.01;

}  // namespace

void Elastic::Impl::update_predictor(const Sheet& sheet, const std::vector<int>& hard) {
  if (!predictor || predicted != hard)
    predictor = std::make_unique<Predictor>(sheet.pattern, sheet.triangles, predicted = hard);
}

void Elastic::Impl::build_linear_system(const Sheet& sheet, const std::vector<int>& fixed,
                                        const std::vector<int>& hard,
                                        const std::vector<std::pair<int, int>>& touching) {
  update_predictor(sheet, hard);
  if (matrix && fixed == held && !matrix_of_contact && touching.empty()) return;
  held = fixed;
  matrix_of_contact = !touching.empty();
  block_of.assign(sheet.x.rows(), 0);
  for (int v : held) block_of[v] = -1;
  int blocks = 0;
  for (int& b : block_of)
    if (b == 0) b = blocks++;
  std::vector<std::pair<int, int>> coupled;
  const auto couple = [&](const std::pair<int, int>& pair) {
    if (const int i = block_of[pair.first], j = block_of[pair.second]; i >= 0 && j >= 0)
      coupled.emplace_back(i, j);
  };
  for (const auto& pair : energy->coupled_vertices()) couple(pair);
  for (const auto& pair : touching) couple(pair);
  matrix = blocks ? std::make_unique<BlockCholesky>(blocks, std::move(coupled)) : nullptr;
  if (matrix) {
    energy->bind(*matrix, block_of);
    softened->bind(*matrix, block_of);
  }
}

void Elastic::Impl::advance(BranchDescent& descent, const IncrementalPotential& W, int most,
                            ElasticReport& report) {
  const bool is_softened = descent.phase == BranchDescent::softened;
  SheetPotential of_soft_sheet = W.sheets.front().with(*softened);
  if (descent.is_lifted) of_soft_sheet.forces.gravity *= -1;
  const IncrementalPotential of_softened{{std::move(of_soft_sheet)}, nullptr};
  const MembraneStress stress =
      is_softened ? MembraneStress(triangles.rows(), Eigen::Matrix2d::Zero())
                  : softened->stress(descent.x, Points3::Zero(descent.x.rows(), 3));
  const auto newton_ways = !is_interactive()    ? NewtonOptions::both
                           : descent.tries == 0 ? NewtonOptions::mixed_newton
                                                : NewtonOptions::line_search_newton;
  const NewtonReport newton = minimise(
      is_softened ? of_softened : W,
      {options.stop, most, mixed_newton_limit(most, is_interactive() ? most : 0), newton_ways},
      stress, descent.x);
  report.iterations += newton.iterations;
  descent.converged = newton.converged;
  if (!descent.converged && is_interactive() && ++descent.tries < max_tries) return;
  descent.phase = is_softened ? BranchDescent::true_stiffness : BranchDescent::finished;
  descent.tries = 0;
}

bool Elastic::Impl::note_locking(const Sheet& sheet) {
  if (!sheet.singular.empty() || !sheet.prescribed_creases.empty()) return false;
  const ElasticEnergy::Parts stored = energy->parts(sheet.x);
  const double all = stored.membrane + stored.bending;
  const bool is_bent = all > least_locked_bend * paper.bending_stiffness;
  if (!is_bent || stored.membrane < ridge_share / 2 * all) state.locked_energy = 0;
  if (!is_bent || stored.membrane < ridge_share * all ||
      all < growth_until_search * state.locked_energy || mean_square_fold(sheet) > fold_that_holds)
    return false;
  state.locked_energy = all;
  return true;
}

BranchSearchReason Elastic::Impl::reason_to_search(const Sheet& sheet, BranchSearchMode mode,
                                                   const ElasticReport& step) {
  // a sheet with inertia gets to a distant shape in time, or does not
  if (options.inertia == Inertia::dynamic) return BranchSearchReason::none;
  const bool slow =
      step.iterations > slow_convergence_iterations || (is_interactive() && !step.converged);
  if (slow && mode == BranchSearchMode::when_slow && state.steps >= state.branch_cooldown_until)
    return BranchSearchReason::slow;
  if (step.converged && note_locking(sheet))
    return mode == BranchSearchMode::when_locked_on_collider
               ? BranchSearchReason::locked_on_collider
               : BranchSearchReason::locked;
  return BranchSearchReason::none;
}

void Elastic::Impl::descend_second_branch(const IncrementalPotential& W,
                                          const SecondBranchSearch& search, Points3& x,
                                          ElasticReport& report) {
  const auto passes = [&](const Points3& to) {
    return options.contact == SelfContact::automatic &&
           !contact->is_collision_free(search.before, to, search.hard);
  };
  const auto begun = [&] {
    BranchDescent descent{search.start};
    descent.is_lifted = search.reason == BranchSearchReason::locked_on_collider;
    return descent;
  };
  std::optional<BranchDescent>& descent = state.second;
  const bool leaves = search.reason != BranchSearchReason::none,
             is_locked = search.reason == BranchSearchReason::locked ||
                         search.reason == BranchSearchReason::locked_on_collider;
  const bool was_under_way = descent.has_value();
  const int total = iteration_budget().total * options.max_iterations / default_iterations;
  if (descent) {
    descent->x = predictor->guesses(descent->x, {}, search.hard).front();
    if (colliders) colliders->project_outside(descent->x);
  } else if (!leaves || (report.converged && passes(x)))
    return;  // a shape that collides with itself is not where the sheet will stay
  else
    descent = begun();
  // a locked sheet is at rest, and its descent must not keep it from being so
  const bool may_be_unfinished = is_interactive() && !is_locked;
  while (descent->phase != BranchDescent::finished) {
    const int left = may_be_unfinished ? std::min(options.max_iterations, total - report.iterations)
                                       : options.max_iterations;
    if (left < std::min(options.max_iterations, min_iterations_to_start)) return;
    advance(*descent, W, left, report);
  }
  const double here = W(x), there = W(descent->x);
  if (!is_interactive() && state.remeshed && there > here - min_relative_gain * std::abs(here))
    state.branch_cooldown_until = state.steps + branch_cooldown_steps;
  const double least_gain = is_locked ? locked_gain * std::abs(here) : 0;
  if (there < here - least_gain && !passes(descent->x)) {
    report.energy_gain = (here - there) / std::max(std::abs(here), 1e-300);
    report.converged = descent->converged;
    state.descending = false;
    x = std::move(descent->x);
    descent.reset();
  } else if (was_under_way && leaves)
    descent = begun();  // starts again from where the main solution has got to
  else
    descent.reset();
}

std::optional<Panels> Elastic::Impl::panels_now() const {
  const std::vector<bool> folded = energy->folded_hinges();
  if (folded.empty()) return std::nullopt;
  return Panels(pattern, triangles, energy->hinges(), folded);
}

void Elastic::Impl::begin_creases(const Sheet& sheet, const StepInput& input,
                                  const StepProblem& step) {
  load_creases(sheet, Curl::removed);
  energy->press(sheet.x, input.pressing);
  softened->press(sheet.x, input.pressing);
  panels.clear();
  if (const std::optional<Panels> parts = panels_now()) {
    const std::vector<double> pressed = energy->pressed_hinges();
    for (const auto& moved :
         {parts->moved(sheet.x, step.hard, pressed), parts->moved_from_pattern(step.hard, pressed)})
      if (moved) panels.push_back(*moved);
  }
  if (contact) contact->set_panels(panels.empty() ? Points3() : panels.front(), paper.thickness);
}

StepProblem Elastic::Impl::problem_of(const Sheet& sheet, const StepInput& input, double dt) {
  PositionConstraints constraints = input.constraints;
  if (colliders) {
    colliders->begin(sheet.x, input.colliders, {});
    colliders->project_outside(constraints);
  }
  return {constraints, hard_constraints(constraints), input.colliders, dt, input.time};
}

namespace {

/// Where the rigid motion takes a sheet that is nearest to the motion of its free vertices to
/// `free`, and of the held ones to their targets.
/// x, free  |V|x3 [m]
Points3 moved_rigidly(const Points3& x, Points3 free, const PositionConstraints& held) {
  for (const PositionConstraint& c : held) free.row(c.vertex) = c.target;
  return moved(motion_with_held(x, free, vertices_of(held)), x);
}

}  // namespace

SheetPotential Elastic::Impl::potential(const Sheet& sheet, const StepProblem& step,
                                        PositionConstraints springs) {
  const bool dynamic = options.inertia == Inertia::dynamic;
  const double dt = step.dt;
  air.reset();
  if (dynamic && options.air.density > 0) air.emplace(options.air, sheet, dt, step.time);
  SheetPotential W{*energy, mass, block_of};
  W.xhat = dynamic ? Points3(sheet.x + dt * sheet.v) : sheet.x;
  W.inertia = (dynamic ? 1 : quasi_static_mass) / (dt * dt);
  if (dynamic && options.damping > 0) {
    const double drag = options.damping * dt;
    W.xhat = (W.xhat + drag * moved_rigidly(sheet.x, W.xhat, step.hard)) / (1 + drag);
    W.inertia *= 1 + drag;
  }
  W.forces = options.forces;
  W.springs = std::move(springs);
  if (colliders) W.colliders = &*colliders;
  if (air) W.air = &*air;
  return W;
}

std::vector<Points3> Elastic::Impl::guesses(const Points3& before, const PositionConstraints& hard,
                                            bool with_contact) {
  std::vector<Points3> all = predictor->guesses(before, state.positions, hard);
  all.insert(all.begin(), panels.begin(), panels.end());
  // handles that carry the sheet as a whole, when it turns
  constexpr double slight_turn = 1e-5;  // [rad]
  if (const auto carried = rigid_motion_of(before, hard, rounding_of_handles);
      carried && !carried->turn.isIdentity(slight_turn))
    all.push_back(moved(*carried, before));
  if (with_contact) {
    if (!state.positions.empty()) all.push_back(2 * before - state.positions[0]);
    all.push_back(before);
  }
  if (colliders)
    for (Points3& guess : all) colliders->project_outside(guess);
  return all;
}

void choose_initial_guess(const IncrementalPotential& W, const Points3& before,
                          std::vector<Points3>& guesses, Points3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (Points3& guess : guesses) {
    if (W.contact) {
      const Points3 move = guess - before;
      W.contact->update_candidates(before, move);
      guess = before + W.contact->collision_free_step(before, move) * move;
    }
    const double value = W(guess);
    if (value < least) {
      least = value;
      x = guess;
    }
  }
  if (!std::isfinite(least)) throw EnergyNotFinite();
}

ElasticReport Elastic::Impl::solve(Sheet& sheet, const StepProblem& step,
                                   SheetContact* self_contact, const NewtonOptions& how,
                                   BranchSearchMode second, StepStart start) {
  // with self-contact the hard handles pull as well, and none is eliminated
  const std::vector<int> hard = vertices_of(step.hard),
                         eliminated = self_contact ? std::vector<int>{} : hard;
  const PositionConstraints springs =
      self_contact ? step.constraints : soft_constraints(step.constraints);
  if (self_contact) self_contact->begin(sheet.x, step.hard, state.friction);
  build_linear_system(
      sheet, eliminated, hard,
      self_contact ? self_contact->coupled_vertices(sheet.x) : std::vector<std::pair<int, int>>{});
  if (self_contact && matrix) self_contact->bind(*matrix, block_of);
  if (colliders)
    colliders->begin(sheet.x, step.colliders, eliminated,
                     self_contact ? step.hard : PositionConstraints{}, state.friction);

  const Points3 before = sheet.x;
  const IncrementalPotential W{{potential(sheet, step, springs)}, self_contact};
  std::vector<Points3> starts = guesses(before, step.hard, self_contact != nullptr);
  choose_initial_guess(W, before, starts, sheet.x);

  ElasticReport report;
  if (matrix && start == StepStart::softened) {
    const IncrementalPotential of_softened{{W.sheets.front().with(*softened)}, nullptr};
    const MembraneStress none(triangles.rows(), Eigen::Matrix2d::Zero());
    report.iterations = minimise(of_softened, how, none, sheet.x).iterations;
  }
  if (matrix) {
    MembraneStress stress = energy->stress(before, Points3::Zero(before.rows(), 3));
    // the stress is that of the change of mesh, not of an equilibrium
    if (state.remeshed) std::fill(stress.begin(), stress.end(), Eigen::Matrix2d::Zero());
    const NewtonReport newton = minimise(W, how, stress, sheet.x);
    report.iterations += newton.iterations;
    report.converged = newton.converged;
    if (second != BranchSearchMode::none) {
      state.descending =
          second == BranchSearchMode::when_slow && newton.descended && !newton.converged;
      if (!newton.aborted) {
        const BranchSearchReason reason = reason_to_search(sheet, second, report);
        descend_second_branch(W, {before, starts.front(), step.hard, reason}, sheet.x, report);
        // where to lift it has led nowhere, its weight may help
        if (reason == BranchSearchReason::locked_on_collider && report.energy_gain == 0)
          descend_second_branch(W, {before, starts.front(), step.hard, BranchSearchReason::locked},
                                sheet.x, report);
      }
      report.snap_in_progress = state.descending || state.second;
    }
  }
  report_constraints(sheet.x, self_contact ? springs : PositionConstraints{}, report);
  friction_at_end.clear();
  if (colliders) colliders->remember(sheet.x, friction_at_end);
  if (self_contact) {
    self_contact->remember(sheet.x, friction_at_end);
    self_contact->update_candidates(sheet.x, Points3::Zero(sheet.x.rows(), 3));
    report.contact = true;
    report.touching = self_contact->touching(sheet.x);
  }
  return report;
}

void Elastic::Impl::report_constraints(const Points3& x, const PositionConstraints& springs,
                                       ElasticReport& report) {
  report.giving_way =
      static_cast<int>(std::count_if(springs.begin(), springs.end(),
                                     [&](const PositionConstraint& c) { return gives_way(c, x); }));
  if (!colliders) return;
  report.on_colliders = colliders->touching(x);
  report.inside = colliders->inside(x);
}

void Elastic::Impl::go_free_of_collisions(const StepProblem& step, const Points3& to, Points3& x) {
  const auto adds_crossings = [&] {
    const CrossingCounter crossings_at(pattern, triangles);
    return crossings_at(to) > crossings_at(x);
  };
  if (!contact || to == x || !adds_crossings()) {
    x = to;
    return;
  }
  contact->begin(x, step.hard);
  Points3 move = Points3::Zero(x.rows(), 3);
  for (int v = 0; v < x.rows(); ++v) {
    if (to.row(v) == x.row(v)) continue;
    move.row(v) = to.row(v) - x.row(v);
    contact->update_candidates(x, move);
    x += contact->collision_free_step(x, move) * move;
    contact->commit_step(x);
    move.row(v).setZero();
  }
}

void Elastic::Impl::finish_step(Sheet& sheet, const Points3& before, const StepProblem& step,
                                ElasticReport& report) {
  if (report.inside > tolerated_depth) {
    Points3 out = sheet.x;
    push_out(step.colliders.to, sheet.x, -tolerated_depth, out);
    go_free_of_collisions(step, out, sheet.x);
    report.inside = colliders->inside(sheet.x);
  }
  state.remeshed = false;
  state.friction = std::move(friction_at_end);
  ++state.steps;
  const std::vector<double> folds = energy->dihedral_angles(sheet.x);
  report.plastic_increment = commit_plastic_state(folds) + commit_creases(sheet, folds);
  report_energies(sheet.x, folds, report);
  const bool damped = options.inertia == Inertia::dynamic && !(options.air.density > 0);
  sheet.v = (damped ? std::pow(velocity_kept, 24 * step.dt) : 1.0) / step.dt * (sheet.x - before);
  state.positions.push_front(before);
  if (state.positions.size() > 2) state.positions.pop_back();
}

}  // namespace paperbake
