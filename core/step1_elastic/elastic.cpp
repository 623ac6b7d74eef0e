#include "core/step1_elastic/solver/elastic_solver_impl.h"

#include "core/geometry/measure.h"
#include "core/step1_elastic/energies/apex_stiffness.h"

namespace paperbake {

const PlasticGrid::Cover& Elastic::Impl::cover() {
  if (!found_cover) found_cover = grid->cover(pattern, triangles);
  return *found_cover;
}

void Elastic::Impl::recall() {
  energy->memory = !grid              ? PlasticMemory{}
                   : grid->pristine() ? PlasticMemory(static_cast<int>(triangles.rows()))
                                      : grid->read(cover());
  softened->memory = energy->memory;
}

void Elastic::Impl::recall_on_new_mesh() {
  found_cover.reset();
  recall();
}

void Elastic::Impl::look_for_ridges(const Sheet& sheet, const std::vector<int>& vertices) {
  if (grid)
    energy->ridges = softened->ridges =
        find_ridges(sheet, energy->hinges(), paper, vertices, energy->memory.ridge);
}

template <class Find, class Solve>
ElasticReport Elastic::Impl::elastic_first(Sheet& sheet, Find find, Solve solve) {
  if (!grid || !grid->pristine() || colliders) {
    find(sheet);
    return solve();
  }
  const Sheet before = sheet;
  const ElasticPast known = past;
  energy->memory = softened->memory = {};
  ElasticReport report = solve();
  recall();
  find(before);
  if (report.converged && !report.leaving &&
      energy->gained(energy->fold_angles(sheet.x)).hardening.isZero(0))
    return report;
  const int in_vain = report.iterations;
  sheet = before;
  past = known;
  report = solve();
  report.iterations += in_vain;
  return report;
}

double Elastic::Impl::remember(const std::vector<double>& fold_angles) {
  if (!grid) return 0;
  const PlasticMemory gained = energy->gained(fold_angles);
  if (gained.curvature.isZero(0) && gained.hardening.isZero(0)) return 0;
  const double growth = grid->write(cover(), gained);
  recall();
  return growth;
}

void Elastic::Impl::tell_stored(const Points3& x, const std::vector<double>& fold_angles,
                                ElasticReport& report) const {
  const ElasticEnergy::Parts parts = energy->parts(x, fold_angles);
  report.membrane = parts.membrane;
  report.energy = parts.membrane + parts.bending;
  report.potential = report.energy + options.gravity * mass.dot(x.col(2));
}

Elastic::Elastic(const Paper& paper, const ElasticOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->paper = paper;
  impl_->options = options;
}
Elastic::~Elastic() = default;
Elastic::Elastic(Elastic&&) = default;
Elastic& Elastic::operator=(Elastic&&) = default;

void Elastic::set_mesh(const Sheet& sheet, const std::vector<double>& stiffening) {
  Impl& s = *impl_;
  std::vector<double> factors = cone_factors(sheet, s.paper);
  if (factors.empty())
    factors = stiffening;
  else
    for (std::size_t t = 0; t < stiffening.size(); ++t) factors[t] *= stiffening[t];
  s.energy.emplace(s.paper, sheet.pattern, sheet.triangles, factors, sheet.folds);
  Paper soft = s.paper;
  soft.membrane_stiffness /= softening;
  s.softened.emplace(soft, sheet.pattern, sheet.triangles, factors, sheet.folds);
  s.matrix.reset();
  s.past.remeshed = true;
  s.predictor.reset();
  if (s.options.contact == SelfContact::automatic)
    s.contact.emplace(sheet.pattern, sheet.triangles, s.paper.friction);
  if (s.options.colliders)
    s.colliders.emplace(s.options.colliders, sheet.triangles,
                        static_cast<int>(sheet.pattern.rows()));
  std::deque<Points3>& positions = s.past.positions;
  if (!positions.empty() && positions.front().rows() != sheet.pattern.rows()) positions.clear();
  if (s.past.second && s.past.second->x.rows() != sheet.pattern.rows()) s.past.second.reset();
  s.pattern = sheet.pattern;
  s.triangles = sheet.triangles;
  s.recall_on_new_mesh();
  s.mass = Eigen::VectorXd::Zero(sheet.pattern.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const double area = rest_triangle(sheet.pattern, sheet.triangles.row(t)).area;
    for (int i = 0; i < 3; ++i) s.mass[sheet.triangles(t, i)] += s.paper.area_density * area / 3;
  }
  s.mean_edge = mean_edge(sheet.pattern, sheet.triangles);
}

void Elastic::remember_in(PlasticGrid* grid) {
  impl_->grid = grid;
  if (impl_->energy) impl_->recall_on_new_mesh();
}

ElasticReport Elastic::look(const Sheet& sheet) const {
  ElasticReport report;
  impl_->tell_stored(sheet.x, impl_->energy->fold_angles(sheet.x), report);
  return report;
}

double Elastic::inside(const Sheet& sheet, const Poses& poses) const {
  if (!impl_->colliders) return 0;
  impl_->colliders->begin(sheet.x, {poses, poses}, {}, 1);
  return impl_->colliders->inside(sheet.x);
}

ElasticReport Elastic::settle(Sheet& sheet, const Held& asked, double dt, Settling settling) {
  Impl& s = *impl_;
  const Held held = s.reachable(sheet, asked, dt);
  const Points3 before = sheet.x;
  const Gripped hard = hard_handles(held);
  constexpr double coarser = 10;  // the next step continues from here
  const bool briefly = settling == Settling::briefly;
  NewtonOptions how{s.options.stop, s.options.max_iterations};
  if (briefly) {
    how.stop *= coarser;
    how.max_iterations = how.max_strides = 20;
    how.ways = NewtonOptions::stride;
    const double far =
        0.03 * (sheet.pattern.colwise().maxCoeff() - sheet.pattern.colwise().minCoeff()).maxCoeff();
    how.in_vain = [&, far](const Points3& x) {
      return (x - before).rowwise().norm().maxCoeff() > far;
    };
  }
  ElasticReport report = s.elastic_first(
      sheet, [](const Sheet&) {},
      [&] { return s.solve(sheet, held, hard, dt, nullptr, how, SecondWays::none); });
  report.contact = s.contact && !s.contact->clear(before, sheet.x, hard);
  s.tell_stored(sheet.x, s.energy->fold_angles(sheet.x), report);
  return report;
}

Elastic Elastic::on_mesh(const Sheet& sheet, const std::vector<double>& stiffening) const {
  Elastic other(impl_->paper, impl_->options);
  other.remember_in(impl_->grid);
  other.set_mesh(sheet, stiffening);
  return other;
}

void Elastic::continue_from(const Elastic& other,
                            const std::function<Points3(const Points3&)>& carried) {
  ElasticPast &here = impl_->past, &there = other.impl_->past;
  here.positions.clear();
  for (const Points3& x : there.positions) here.positions.push_back(carried(x));
  here.steps = there.steps;
  here.content_until = there.content_until;
  here.second = there.second;
  if (here.second) here.second->x = carried(there.second->x);
}

ElasticPast Elastic::past() const {
  ElasticPast copy = impl_->past;
  copy.ridges = impl_->energy->ridges;
  if (impl_->grid && !impl_->grid->pristine()) copy.grid = *impl_->grid;
  return copy;
}

void Elastic::take_back(const ElasticPast& past) {
  Impl& s = *impl_;
  s.past = past;
  s.energy->ridges = s.softened->ridges = std::exchange(s.past.ridges, {});
  if (!s.grid) return;
  if (past.grid)
    *s.grid = *past.grid;
  else
    s.grid->forget();
  s.past.grid.reset();
  s.recall();
}

ElasticReport Elastic::Impl::go(Sheet& sheet, const Held& held, const Gripped& hard, double dt) {
  const Points3 before = sheet.x;
  ElasticReport report;
  const bool may_touch = options.contact == SelfContact::automatic;
  const double stop = options.stop;
  if (!may_touch || !past.careful) {
    // a sheet that rests on a collider has no second branch, and needs few mixed Newton iterations
    const bool lies = colliders && colliders->touching(before) > 0;
    if (lies) past.second.reset(), past.descending = false;
    const int most = lies ? options.max_iterations : most_iterations();
    NewtonOptions how{
        stop, most, std::min({25, most, 2 * most / 3 + (is_coarse() ? 5 : 0)}),
        is_coarse() && past.descending ? NewtonOptions::descend : NewtonOptions::both};
    if (may_touch) how.in_vain = [&](const Points3& x) { return !contact->clear(before, x, hard); };
    if (lies) how.max_strides = std::min(how.max_strides, most_strides_on_colliders);
    report = solve(sheet, held, hard, dt, nullptr, how,
                   lies ? SecondWays::none : SecondWays::where_restless);
    report.leaving |= lies && !report.converged;
    const int more = most_more * options.max_iterations / usual_iterations;
    if (is_coarse() && !lies && !report.converged && more > 0 &&
        largest_stretch(sheet) > on_the_way) {
      const ElasticReport so_far = report;
      report = solve(sheet, held, hard, dt, nullptr, {stop, more, more, NewtonOptions::descend},
                     SecondWays::none);
      report.iterations += so_far.iterations;
      report.lower_branch = so_far.lower_branch;
      report.leaving = so_far.leaving && !report.converged;
      past.descending &= !report.converged;
    }
  }
  const auto jams = [&] {  // an unfinished step may be stretched without being jammed
    return (report.converged && matrix && largest_stretch(sheet) > jam_stretch) ||
           report.inside > jam_inside;
  };
  if (may_touch && (past.careful || jams() || !contact->clear(before, sheet.x, hard))) {
    const int in_vain = report.iterations;
    sheet.x = before;
    // close to itself a softened sheet soon collides with its own parts: a second branch finds
    // nothing better there
    const NewtonOptions how{stop, most_in_touch()};
    report = solve(sheet, held, hard, dt, &*contact, how, SecondWays::none);
    report.iterations += in_vain;
    past.second.reset();
    past.descending = false;
    past.careful = report.touching > 0 || report.yielding > 0;
  }
  return report;
}

ElasticReport Elastic::step(Sheet& sheet, const Held& asked, double dt) {
  Impl& s = *impl_;
  const Held held = s.reachable(sheet, asked, dt);
  const Gripped hard = hard_handles(held);
  const Points3 before = sheet.x;
  ElasticReport report = s.elastic_first(
      sheet, [&](const Sheet& from) { s.look_for_ridges(from, held.vertices); },
      [&] { return s.go(sheet, held, hard, dt); });
  s.conclude(sheet, before, held, dt, report);
  return report;
}

}  // namespace paperbake
