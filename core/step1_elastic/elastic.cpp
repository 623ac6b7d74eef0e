#include "core/step1_elastic/solver/elastic_solver_impl.h"

#include "core/geometry/measure.h"
#include "core/step1_elastic/energies/apex_stiffness.h"

namespace paperbake {

const PlasticGrid::Cover& Elastic::Impl::cover() {
  if (!found_cover) found_cover = grid->cover(pattern, triangles);
  return *found_cover;
}

void Elastic::Impl::load_plastic_state() {
  energy->memory = !grid               ? PlasticMemory{}
                   : grid->is_virgin() ? PlasticMemory(static_cast<int>(triangles.rows()))
                                       : grid->read(cover());
  softened->memory = energy->memory;
}

void Elastic::Impl::load_plastic_state_on_new_mesh() {
  found_cover.reset();
  load_plastic_state();
}

void Elastic::Impl::find_ridges_of_step(const Sheet& sheet, const std::vector<int>& vertices) {
  if (grid)
    energy->ridges = softened->ridges =
        find_ridges(sheet, energy->hinges(), paper, vertices, energy->memory.ridge);
}

template <class Find, class Solve>
ElasticReport Elastic::Impl::try_without_plasticity(Sheet& sheet, Find find, Solve solve) {
  if (!grid || !grid->is_virgin() || colliders || energy->has_creases()) {
    find(sheet);
    return solve();
  }
  const Sheet before = sheet;
  const SolverState known = state;
  energy->memory = softened->memory = {};
  ElasticReport report = solve();
  load_plastic_state();
  find(before);
  if (report.converged && !report.snap_in_progress &&
      energy->gained(energy->dihedral_angles(sheet.x)).hardening.isZero(0))
    return report;
  const int wasted_iterations = report.iterations;
  sheet = before;
  state = known;
  report = solve();
  report.iterations += wasted_iterations;
  return report;
}

double Elastic::Impl::load_creases(const Sheet& sheet, Curl curl) {
  softened->load_creases(sheet);
  const std::vector<int> beside = energy->load_creases(sheet);
  if (curl == Curl::stays || beside.empty() || !grid || grid->is_virgin()) return 0;
  PlasticMemory removed(static_cast<int>(triangles.rows()));
  for (const int t : beside) removed.curvature.row(t) = -energy->memory.curvature.row(t);
  const double growth = grid->write(cover(), removed);
  load_plastic_state();
  return growth;
}

double Elastic::Impl::commit_creases(Sheet& sheet, const std::vector<double>& dihedral_angles) {
  if (!energy->has_creases()) return 0;
  sheet.crease_edges = energy->creases_left(dihedral_angles);
  return load_creases(sheet, Curl::removed);
}

double Elastic::Impl::commit_plastic_state(const std::vector<double>& dihedral_angles) {
  if (!grid) return 0;
  const PlasticMemory gained = energy->gained(dihedral_angles);
  if (gained.curvature.isZero(0) && gained.hardening.isZero(0)) return 0;
  const double growth = grid->write(cover(), gained);
  load_plastic_state();
  return growth;
}

void Elastic::Impl::report_energies(const Points3& x, const std::vector<double>& dihedral_angles,
                                    ElasticReport& report) const {
  const ElasticEnergy::Parts parts = energy->parts(x, dihedral_angles);
  report.membrane = parts.membrane;
  report.energy = parts.membrane + parts.bending;
  report.potential = report.energy + options.forces.energy(mass, x);
}

Elastic::Elastic(const Paper& paper, const ElasticOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->paper = paper;
  impl_->options = options;
}
Elastic::~Elastic() = default;
Elastic::Elastic(Elastic&&) = default;
Elastic& Elastic::operator=(Elastic&&) = default;

const Paper& Elastic::paper() const { return impl_->paper; }

void Elastic::set_mesh(const Sheet& sheet, const std::vector<double>& stiffening) {
  Impl& s = *impl_;
  std::vector<double> factors = apex_stiffness_factors(sheet, s.paper);
  if (factors.empty())
    factors = stiffening;
  else
    for (std::size_t t = 0; t < stiffening.size(); ++t) factors[t] *= stiffening[t];
  s.energy.emplace(s.paper, sheet.pattern, sheet.triangles, factors, sheet.prescribed_creases);
  Paper softened_paper = s.paper;
  softened_paper.membrane_stiffness /= softening;
  s.softened.emplace(softened_paper, sheet.pattern, sheet.triangles, factors,
                     sheet.prescribed_creases);
  s.load_creases(sheet, Impl::Curl::stays);
  s.matrix.reset();
  s.state.remeshed = true;
  s.predictor.reset();
  if (s.options.contact == SelfContact::automatic)
    s.contact.emplace(sheet.pattern, sheet.triangles, s.paper.friction, s.options.sheet_number);
  if (s.options.colliders)
    s.colliders.emplace(s.options.colliders, sheet.triangles,
                        static_cast<int>(sheet.pattern.rows()));
  std::deque<Points3>& positions = s.state.positions;
  if (!positions.empty() && positions.front().rows() != sheet.pattern.rows()) positions.clear();
  if (s.state.second && s.state.second->x.rows() != sheet.pattern.rows()) s.state.second.reset();
  s.pattern = sheet.pattern;
  s.triangles = sheet.triangles;
  s.load_plastic_state_on_new_mesh();
  s.mass = Eigen::VectorXd::Zero(sheet.pattern.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const double area = rest_triangle(sheet.pattern, sheet.triangles.row(t)).area;
    for (int i = 0; i < 3; ++i) s.mass[sheet.triangles(t, i)] += s.paper.area_density * area / 3;
  }
  s.mean_edge = mean_edge(sheet.pattern, sheet.triangles);
}

void Elastic::set_inertia(Inertia inertia, double damping) {
  impl_->options.inertia = inertia;
  impl_->options.damping = damping;
}

Inertia Elastic::inertia() const { return impl_->options.inertia; }

void Elastic::set_plastic_grid(PlasticGrid* grid) {
  impl_->grid = grid;
  if (impl_->energy) impl_->load_plastic_state_on_new_mesh();
}

ElasticReport Elastic::evaluate_energies(const Sheet& sheet) {
  ElasticReport report;
  impl_->load_creases(sheet, Impl::Curl::stays);
  impl_->report_energies(sheet.x, impl_->energy->dihedral_angles(sheet.x), report);
  return report;
}

LocalEnergies Elastic::local_energies(const Sheet& sheet) {
  impl_->load_creases(sheet, Impl::Curl::stays);
  return impl_->energy->local_energies(sheet.x);
}

/// [m] As in Elastic::inside. contact  that of a sheet on this mesh, with what it knows of sides
static double depth_at_rest(ColliderContact contact, const Points3& x,
                            const ColliderShapes& shapes) {
  contact.begin(x, {shapes, shapes}, {});
  return contact.inside(x);
}

double Elastic::inside(const Sheet& sheet, const ColliderShapes& shapes) const {
  // a copy: the step that its own contact is in goes on
  return impl_->colliders ? depth_at_rest(*impl_->colliders, sheet.x, shapes) : 0;
}

double Elastic::inside_on_mesh_of(const Sheet& sheet, const ColliderShapes& shapes) const {
  if (!impl_->options.colliders) return 0;
  return depth_at_rest(
      {impl_->options.colliders, sheet.triangles, static_cast<int>(sheet.x.rows())}, sheet.x,
      shapes);
}

bool Elastic::leave_colliders(Sheet& sheet, const ColliderShapes& shapes,
                              const PositionConstraints& held) const {
  if (!impl_->colliders) return true;
  constexpr int most_passes = 32;
  // [m] outside, as much as it may be inside: the next step is not to begin at the bound
  constexpr double clearance = give_way_depth;
  ColliderContact at_rest = *impl_->colliders;
  at_rest.begin(sheet.x, {shapes, shapes}, {});
  double depth = at_rest.inside(sheet.x);
  if (depth <= give_way_depth) return true;
  std::vector<char> stays(sheet.x.rows(), 0);
  for (const PositionConstraint& c : held) stays[c.vertex] = 1;
  for (int pass = 0; pass < most_passes && depth > 0; ++pass) {
    at_rest.push_out(stays, clearance, sheet.x);
    depth = at_rest.inside(sheet.x);
  }
  return depth <= give_way_depth;
}

ElasticReport Elastic::relax(Sheet& sheet, const StepInput& input, double dt, Relaxation how_far) {
  Impl& s = *impl_;
  const StepProblem problem = s.problem_of(sheet, input, dt);
  s.begin_creases(sheet, input, problem);
  const Points3 before = sheet.x;
  const bool coarse = how_far != Relaxation::full;
  NewtonOptions how{s.options.stop, s.options.max_iterations};
  if (coarse) {
    how.stop *= coarse_stop;
    how.max_iterations = how.max_mixed_newton = max_coarse_iterations;
    how.ways = NewtonOptions::mixed_newton;
    const double max_displacement = max_coarse_move * longer_side(sheet.pattern);
    how.should_abort = [&, max_displacement](const Points3& x) {
      return max_row_norm(x - before) > max_displacement;
    };
  }
  ElasticReport report = s.try_without_plasticity(
      sheet, [](const Sheet&) {},
      [&] {
        return s.solve(
            sheet, problem, nullptr, how, BranchSearchMode::none,
            how_far == Relaxation::softened_first ? StepStart::softened : StepStart::guess);
      });
  report.contact = s.contact && !s.contact->is_collision_free(before, sheet.x, problem.hard);
  s.report_energies(sheet.x, s.energy->dihedral_angles(sheet.x), report);
  return report;
}

Elastic Elastic::on_mesh(const Sheet& sheet, const std::vector<double>& stiffening) const {
  Elastic other(impl_->paper, impl_->options);
  other.set_plastic_grid(impl_->grid);
  other.set_mesh(sheet, stiffening);
  return other;
}

void Elastic::continue_from(const Elastic& other,
                            const std::function<Points3(const Points3&)>& carried) {
  SolverState& here = impl_->state;
  const SolverState& there = other.impl_->state;
  here.positions.clear();
  for (const Points3& x : there.positions) here.positions.push_back(carried(x));
  here.steps = there.steps;
  here.branch_cooldown_until = there.branch_cooldown_until;
  here.second = there.second;
  if (here.second) here.second->x = carried(there.second->x);
}

SolverState Elastic::state() const {
  SolverState copy = impl_->state;
  copy.ridges = impl_->energy->ridges;
  if (impl_->grid && !impl_->grid->is_virgin()) copy.grid = *impl_->grid;
  return copy;
}

void Elastic::restore(const SolverState& state) {
  Impl& s = *impl_;
  s.state = state;
  s.energy->ridges = s.softened->ridges = std::exchange(s.state.ridges, {});
  if (!s.grid) return;
  if (state.grid)
    *s.grid = *state.grid;
  else
    s.grid->reset();
  s.state.grid.reset();
  s.load_plastic_state();
}

ElasticReport Elastic::Impl::step_without_contact(Sheet& sheet, const StepProblem& step) {
  // a sheet that rests on a collider has no second branch unless it is locked, and needs few mixed
  // Newton iterations
  const bool rests_on_collider = colliders && colliders->touching(sheet.x) > 0;
  if (rests_on_collider) {
    state.second.reset();
    state.descending = false;
  }
  const int most = rests_on_collider ? options.max_iterations : max_iterations_of_step();
  NewtonOptions how{options.stop, most, mixed_newton_limit(most, is_interactive() ? 5 : 0),
                    is_interactive() && state.descending ? NewtonOptions::line_search_newton
                                                         : NewtonOptions::both};
  if (contact)
    how.should_abort = [this, &step, before = sheet.x](const Points3& x) {
      return !contact->is_collision_free(before, x, step.hard);
    };
  if (rests_on_collider)
    how.max_mixed_newton = std::min(how.max_mixed_newton, max_mixed_newton_on_colliders);
  ElasticReport report = solve(
      sheet, step, nullptr, how,
      rests_on_collider ? BranchSearchMode::when_locked_on_collider : BranchSearchMode::when_slow);
  report.snap_in_progress |= rests_on_collider && !report.converged;
  const int more = extra_iterations * options.max_iterations / default_iterations;
  if (!is_interactive() || rests_on_collider || report.converged || more < 1 ||
      largest_stretch(sheet) <= unfinished_stretch)
    return report;
  const ElasticReport so_far = report;
  report =
      solve(sheet, step, nullptr, {options.stop, more, more, NewtonOptions::line_search_newton},
            BranchSearchMode::none);
  report.iterations += so_far.iterations;
  report.energy_gain = so_far.energy_gain;
  report.snap_in_progress = so_far.snap_in_progress && !report.converged;
  state.descending &= !report.converged;
  return report;
}

ElasticReport Elastic::Impl::step_with_contact(Sheet& sheet, const StepProblem& step) {
  // close to itself a softened sheet soon collides with its own parts: a second branch finds
  // nothing better there
  const NewtonOptions how{options.stop, max_contact_iterations()};
  ElasticReport report = solve(sheet, step, &*contact, how, BranchSearchMode::none);
  state.second.reset();
  state.descending = false;
  state.had_contact = report.has_contact();
  return report;
}

ElasticReport Elastic::Impl::step_with_contact_fallback(Sheet& sheet, const StepProblem& step) {
  if (!contact) return step_without_contact(sheet, step);
  if (state.had_contact) return step_with_contact(sheet, step);
  const Points3 before = sheet.x;
  const ElasticReport free = step_without_contact(sheet, step);
  // also when the step is unfinished: where hands pull paper taut round a collider, hard handles
  // may have no end that the iterations reach
  const bool jams =
      (matrix && largest_stretch(sheet) > give_way_stretch) || free.inside > give_way_depth;
  if (!jams && contact->is_collision_free(before, sheet.x, step.hard)) return free;
  sheet.x = before;
  ElasticReport report = step_with_contact(sheet, step);
  report.iterations += free.iterations;
  return report;
}

PositionConstraints Elastic::half_way(const Sheet& sheet,
                                      const PositionConstraints& constraints) const {
  if (const std::optional<Panels> panels = impl_->panels_now())
    return panels->half_way(sheet.x, constraints);
  const auto carried = rigid_motion_of(sheet.x, constraints, rounding_of_handles);
  PositionConstraints half = constraints;
  for (PositionConstraint& c : half) {
    const Vector3d from = sheet.x.row(c.vertex);
    c.target =
        carried ? paperbake::half_way(*carried, from, c.target) : Vector3d(0.5 * (from + c.target));
  }
  return half;
}

ElasticReport Elastic::step(Sheet& sheet, const StepInput& input, double dt) {
  Impl& s = *impl_;
  const StepProblem problem = s.problem_of(sheet, input, dt);
  s.begin_creases(sheet, input, problem);
  const Points3 before = sheet.x;
  ElasticReport report = s.try_without_plasticity(
      sheet,
      [&](const Sheet& from) { s.find_ridges_of_step(from, vertices_of(problem.constraints)); },
      [&] { return s.step_with_contact_fallback(sheet, problem); });
  s.finish_step(sheet, before, problem, report);
  return report;
}

}  // namespace paperbake
