#include "core/step1_elastic/elastic.h"

#include "core/error.h"
#include "core/measure.h"
#include "core/step1_elastic/colliders.h"
#include "core/step1_elastic/cone_energy.h"
#include "core/step1_elastic/contact.h"
#include "core/step1_elastic/elastic_energy.h"
#include "core/step1_elastic/handle_springs.h"
#include "core/step1_elastic/newton.h"
#include "core/step1_elastic/patience.h"
#include "core/step1_elastic/predictor.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

namespace paperbake {
namespace {

constexpr double quasi_static_mass = 0.01;  // share of the true mass; 1 ... 1e-5 give the same shapes to 4 digits
constexpr double velocity_kept = 0.98;  // [1] in 1/24 s

}  // namespace

struct Elastic::Impl {
  Paper paper;
  ElasticOptions options;

  std::optional<ElasticEnergy> energy, softened;
  Eigen::VectorXd mass;
  double mean_edge = 0;
  ElasticPast past;          // positions are emptied when the number of vertices changes
  PlasticGrid* grid = nullptr;
  Points2 pattern;
  Triangles triangles;
  std::optional<PlasticGrid::Cover> found_cover;  // of the grid by the triangles, when it was first needed

  std::optional<Contact> contact;
  std::optional<ColliderContact> colliders;

  // belongs to the mesh and the set of held vertices
  std::vector<int> held;     // left out of the solve
  std::vector<int> guided;   // taken along by the predictor
  std::vector<int> block_of;
  std::unique_ptr<BlockCholesky> matrix;
  bool matrix_of_contact = false;
  std::unique_ptr<Predictor> predictor;

  const PlasticGrid::Cover& cover() {
    if (!found_cover) found_cover = grid->cover(pattern, triangles);
    return *found_cover;
  }

  void recall() {
    energy->memory = !grid ? PlasticMemory{} : grid->pristine() ? PlasticMemory(static_cast<int>(triangles.rows())) : grid->read(cover());
    softened->memory = energy->memory;
  }

  void recall_on_new_mesh() {
    found_cover.reset();
    recall();
  }

  /// Where the sheet bends in two directions as a step begins, it yields as ridges do.
  void look_for_ridges(const Sheet& sheet, const std::vector<int>& vertices) {
    if (grid) energy->ridges = softened->ridges = find_ridges(sheet, energy->hinges(), paper, vertices, energy->memory.ridge);
  }

  /// What has flowed goes to the grid and comes back as the past of the next step. returns the growth of the integral [m rad]
  double remember(const std::vector<double>& fold_angles) {
    if (!grid) return 0;
    const PlasticMemory gained = energy->gained(fold_angles);
    if (gained.curvature.isZero(0) && gained.hardening.isZero(0)) return 0;
    const double growth = grid->write(cover(), gained);
    recall();
    return growth;
  }

  /// What is stored in the sheet goes to the report.
  void tell_stored(const Points3& x, const std::vector<double>& fold_angles, ElasticReport& report) const {
    const ElasticEnergy::Parts parts = energy->parts(x, fold_angles);
    report.membrane = parts.membrane;
    report.energy = parts.membrane + parts.bending;
    report.potential = report.energy + options.gravity * mass.dot(x.col(2));
  }

  /// touching: pairs of vertices that contact couples
  void hold(const Sheet& sheet, const std::vector<int>& fixed, const std::vector<int>& hard, const std::vector<std::pair<int, int>>& touching) {
    if (!predictor || guided != hard) predictor = std::make_unique<Predictor>(sheet.pattern, sheet.triangles, guided = hard);
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
      if (const int i = block_of[pair.first], j = block_of[pair.second]; i >= 0 && j >= 0) coupled.emplace_back(i, j);
    };
    for (const auto& pair : energy->coupled_vertices()) couple(pair);
    for (const auto& pair : touching) couple(pair);
    matrix = blocks ? std::make_unique<BlockCholesky>(blocks, std::move(coupled)) : nullptr;
    if (matrix) energy->bind(*matrix, block_of), softened->bind(*matrix, block_of);
  }

  bool is_coarse() const { return triangles.rows() <= coarse; }
  Patience patience() const { return past.second ? beside_another : past.steps < 3 ? at_first : later; }
  int most_iterations() const {
    return is_coarse() ? std::max(1, patience().on_the_first * options.max_iterations / usual_iterations) : options.max_iterations;
  }

  /// stress  of the membrane where x came from
  NewtonReport minimise(const IncrementalPotential& W, const NewtonOptions& how, const MembraneStress& stress, Points3& x) {
    return paperbake::minimise({W, *matrix, block_of, mean_edge, paper.membrane_stiffness}, how, stress, x);
  }

  /// The next leg of the second way, as far as `most` iterations take it. On a coarse mesh it is one of the two ways down.
  void go_on(SecondWay& way, const IncrementalPotential& W, int most, ElasticReport& report) {
    const bool soft = way.leg == SecondWay::soft;
    const IncrementalPotential gentle{*softened, mass, W.xhat, W.inertia, W.gravity, W.springs, nullptr, W.colliders};
    const MembraneStress stress = soft ? MembraneStress(triangles.rows(), Eigen::Matrix2d::Zero())
                                       : softened->stress(way.x, Points3::Zero(way.x.rows(), 3));
    const auto ways = !is_coarse() ? NewtonOptions::both : way.tries == 0 ? NewtonOptions::stride : NewtonOptions::descend;
    const NewtonReport newton = minimise(soft ? gentle : W, {options.stop, most, std::min(25, is_coarse() ? most : 2 * most / 3), ways}, stress, way.x);
    report.iterations += newton.iterations;
    way.converged = newton.converged;
    if (!way.converged && is_coarse() && ++way.tries < most_tries) return;
    way.leg = soft ? SecondWay::stiff : SecondWay::done;
    way.tries = 0;
  }

  /// A second way down from an unstable shape, first with the softened membrane; taken when it ends lower.
  /// before  where this step began
  /// start   the guess from there
  void second_way(const IncrementalPotential& W, const Points3& before, const Points3& start, const Gripped& hard, Points3& x, ElasticReport& report) {
    const auto passes = [&](const Points3& to) { return options.contact == SelfContact::automatic && !contact->clear(before, to, hard); };
    std::optional<SecondWay>& way = past.second;
    const bool leaves = report.iterations > restless || (is_coarse() && !report.converged);
    const bool begun_before = way.has_value();
    const int in_all = patience().in_all * options.max_iterations / usual_iterations;
    if (way) {
      way->x = predictor->guesses(way->x, {}, hard.targets).front();
      if (colliders) colliders->clear_way(way->x);
    }
    else if (!leaves || (report.converged && passes(x))) return;  // what meets itself is not going to stay where it is
    else if (past.steps < past.content_until) return;
    else way = SecondWay{start};
    while (way->leg != SecondWay::done) {
      const int left = is_coarse() ? std::min(options.max_iterations, in_all - report.iterations) : options.max_iterations;
      if (left < std::min(options.max_iterations, worth_a_try)) return;
      go_on(*way, W, left, report);
    }
    const double here = W(x), there = W(way->x);
    if (!is_coarse() && past.remeshed && there > here - worth_having * std::abs(here)) past.content_until = past.steps + content_for;
    if (there < here && !passes(way->x)) {
      report.lower_branch = (here - there) / std::max(std::abs(here), 1e-300);
      report.converged = way->converged;
      past.descending = false;
      x = std::move(way->x);
      way.reset();
    } else if (begun_before && leaves) way = SecondWay{start};  // from where the first way has got to since
    else way.reset();
  }

  /// Handles as far as colliders let them go.
  Held reachable(const Sheet& sheet, const Held& held, double dt) {
    Held reached = held;
    if (!colliders) return reached;
    colliders->begin(sheet.x, held.colliders, {}, dt);
    colliders->clear_way(held.vertices, reached.targets);
    return reached;
  }

  /// One step; `feels` is null for a sheet that does not feel itself.
  ElasticReport solve(Sheet& sheet, const Held& handles, const Gripped& hard, double dt, Contact* feels, const NewtonOptions& how,
                      SecondWays second) {
    const std::vector<HandleSpring> springs = handle_springs(handles, feels ? HardHandles::may_yield : HardHandles::are_held);
    if (feels) feels->begin(sheet.x, hard);
    hold(sheet, feels ? std::vector<int>{} : hard.vertices, hard.vertices,
         feels ? feels->coupled_vertices(sheet.x) : std::vector<std::pair<int, int>>{});
    if (feels && matrix) feels->bind(*matrix, block_of);
    if (colliders) colliders->begin(sheet.x, handles.colliders, feels ? std::vector<int>{} : hard.vertices, dt, feels ? hard : Gripped{});

    const bool dynamic = options.inertia == Inertia::dynamic;
    const Points3 before = sheet.x;
    const IncrementalPotential W{*energy, mass, dynamic ? Points3(before + dt * sheet.v) : before,
                                 (dynamic ? 1 : quasi_static_mass) / (dt * dt), options.gravity, springs, feels, colliders ? &*colliders : nullptr};

    // start from the guess of least potential
    double least = std::numeric_limits<double>::infinity();
    std::vector<Points3> guesses = predictor->guesses(before, past.positions, hard.targets);
    if (feels) {  // where handles lag behind, they need not jump
      if (!past.positions.empty()) guesses.push_back(2 * before - past.positions[0]);
      guesses.push_back(before);
    }
    for (Points3& guess : guesses) {
      if (colliders) colliders->clear_way(guess);
      if (feels) {
        const Points3 move = guess - before;
        feels->cover(before, move);
        guess = before + feels->free_way(before, move) * move;
      }
      const double value = W(guess);
      if (value < least) least = value, sheet.x = guess;
    }
    if (!std::isfinite(least)) throw Error(Fault::simulation, "elastic step", "The energy of the sheet is not finite.");

    ElasticReport report;
    if (matrix) {
      MembraneStress stress = energy->stress(before, Points3::Zero(before.rows(), 3));
      if (past.remeshed) std::fill(stress.begin(), stress.end(), Eigen::Matrix2d::Zero());  // not in equilibrium: what the mesh did
      const NewtonReport newton = minimise(W, how, stress, sheet.x);
      report.iterations = newton.iterations;
      report.converged = newton.converged;
      if (second == SecondWays::where_restless) {
        past.descending = newton.descended && !newton.converged;
        if (!newton.in_vain) second_way(W, before, guesses.front(), hard, sheet.x, report);
        report.leaving = past.descending || past.second;
      }
    }
    if (colliders) {
      report.on_colliders = colliders->touching(sheet.x);
      report.inside = colliders->inside(sheet.x);
    }
    if (feels) {
      feels->cover(sheet.x, Points3::Zero(sheet.x.rows(), 3));
      report.contact = true;
      report.touching = feels->active(sheet.x);
      report.yielding = static_cast<int>(std::count_if(springs.begin(), springs.end(), [&](const HandleSpring& s) { return yields(s, sheet.x); }));
    }
    return report;
  }
};

Elastic::Elastic(const Paper& paper, const ElasticOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->paper = paper;
  impl_->options = options;
}
Elastic::~Elastic() = default;
Elastic::Elastic(Elastic&&) = default;
Elastic& Elastic::operator=(Elastic&&) = default;

void Elastic::set_mesh(const Sheet& sheet, const std::vector<double>& stiffening) {
  Impl& s = *impl_;
  std::vector<double> factors = cone_factors(sheet, s.paper);
  if (factors.empty()) factors = stiffening;
  else for (std::size_t t = 0; t < stiffening.size(); ++t) factors[t] *= stiffening[t];
  s.energy.emplace(s.paper, sheet.pattern, sheet.triangles, factors, sheet.folds);
  Paper soft = s.paper;
  soft.membrane_stiffness /= softening;
  s.softened.emplace(soft, sheet.pattern, sheet.triangles, factors, sheet.folds);
  s.matrix.reset();
  s.past.remeshed = true;
  s.predictor.reset();
  if (s.options.contact == SelfContact::automatic) s.contact.emplace(sheet.pattern, sheet.triangles);
  if (s.options.colliders) s.colliders.emplace(s.options.colliders, sheet.triangles, static_cast<int>(sheet.pattern.rows()));
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
  constexpr double coarser = 10;  // the next step goes on from here
  const bool briefly = settling == Settling::briefly;
  NewtonOptions how{s.options.stop, s.options.max_iterations};
  if (briefly) {
    how.stop *= coarser;
    how.max_iterations = how.max_strides = 20;
    how.ways = NewtonOptions::stride;
    const double far = 0.03 * (sheet.pattern.colwise().maxCoeff() - sheet.pattern.colwise().minCoeff()).maxCoeff();
    how.in_vain = [&, far](const Points3& x) { return (x - before).rowwise().norm().maxCoeff() > far; };
  }
  ElasticReport report = s.solve(sheet, held, hard, dt, nullptr, how, SecondWays::none);
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

void Elastic::continue_from(const Elastic& other, const std::function<Points3(const Points3&)>& carried) {
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
  if (past.grid) *s.grid = *past.grid;
  else s.grid->forget();
  s.past.grid.reset();
  s.recall();
}

ElasticReport Elastic::step(Sheet& sheet, const Held& asked, double dt) {
  Impl& s = *impl_;
  const Held held = s.reachable(sheet, asked, dt);
  const Points3 before = sheet.x;
  Gripped hard = hard_handles(held);
  s.look_for_ridges(sheet, held.vertices);
  ElasticReport report;
  const bool may_touch = s.options.contact == SelfContact::automatic;
  const double stop = s.options.stop;
  if (!may_touch || !s.past.careful) {
    // what lies on something has no second start either, and need not stride far
    const bool lies = s.colliders && s.colliders->touching(before) > 0;
    if (lies) s.past.second.reset(), s.past.descending = false;
    const int most = lies ? s.options.max_iterations : s.most_iterations();
    NewtonOptions how{stop, most, std::min({25, most, 2 * most / 3 + (s.is_coarse() ? 5 : 0)}), s.is_coarse() && s.past.descending ? NewtonOptions::descend : NewtonOptions::both};
    if (may_touch) how.in_vain = [&](const Points3& x) { return !s.contact->clear(before, x, hard); };
    if (lies) how.max_strides = std::min(how.max_strides, most_strides_on_colliders);
    report = s.solve(sheet, held, hard, dt, nullptr, how, lies ? SecondWays::none : SecondWays::where_restless);
    report.leaving |= lies && !report.converged;
  }
  const auto jams = [&] {  // what is on its way may be stretched
    return (report.converged && s.matrix && largest_stretch(sheet) > jam_stretch) || report.inside > jam_inside;
  };
  if (may_touch && (s.past.careful || jams() || !s.contact->clear(before, sheet.x, hard))) {
    const int in_vain = report.iterations;
    sheet.x = before;
    // beside itself the softened sheet soon meets its own parts: a second start finds nothing better there
    const NewtonOptions how{stop, std::min(s.options.max_iterations, s.is_coarse() ? most_in_touch_coarse : most_iterations_in_touch)};
    report = s.solve(sheet, held, hard, dt, &*s.contact, how, SecondWays::none);
    report.iterations += in_vain;
    s.past.second.reset();
    s.past.descending = false;
    s.past.careful = report.touching > 0 || report.yielding > 0;
  }
  constexpr double let_in = 5e-5;  // [m]
  if (report.inside > let_in) {
    push_out(*s.options.colliders, held.colliders.to, Points3(sheet.x), -let_in, sheet.x);
    report.inside = s.colliders->inside(sheet.x);
  }
  s.past.remeshed = false;
  ++s.past.steps;
  const std::vector<double> folds = s.energy->fold_angles(sheet.x);
  report.plastic_flow = s.remember(folds);
  s.tell_stored(sheet.x, folds, report);
  sheet.v = (s.options.inertia == Inertia::dynamic ? std::pow(velocity_kept, 24 * dt) : 1.0) / dt * (sheet.x - before);
  s.past.positions.push_front(before);
  if (s.past.positions.size() > 2) s.past.positions.pop_back();
  return report;
}

}  // namespace paperbake
