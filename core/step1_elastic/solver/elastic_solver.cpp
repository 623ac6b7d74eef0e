#include "core/step1_elastic/solver/elastic_solver_impl.h"

#include "core/geometry/measure.h"
#include "core/model/error.h"

#include <cmath>
#include <limits>

namespace paperbake {
namespace {

// fraction of the true mass; values from 1 to 1e-5 give the same shapes to 4 digits
constexpr double quasi_static_mass = 0.01;
constexpr double velocity_kept = 0.98;  // [1] per 1/24 s

}  // namespace

void Elastic::Impl::guide(const Sheet& sheet, const std::vector<int>& hard) {
  if (!predictor || guided != hard)
    predictor = std::make_unique<Predictor>(sheet.pattern, sheet.triangles, guided = hard);
}

void Elastic::Impl::hold(const Sheet& sheet, const std::vector<int>& fixed,
                         const std::vector<int>& hard,
                         const std::vector<std::pair<int, int>>& touching) {
  guide(sheet, hard);
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
  if (matrix) energy->bind(*matrix, block_of), softened->bind(*matrix, block_of);
}

void Elastic::Impl::go_on(SecondWay& way, const IncrementalPotential& W, int most,
                          ElasticReport& report) {
  const bool soft = way.leg == SecondWay::soft;
  const SheetPotential& own = W.sheets.front();
  const IncrementalPotential gentle{
      {{*softened, mass, own.xhat, own.inertia, own.gravity, own.springs, own.colliders, block_of}},
      nullptr};
  const MembraneStress stress = soft ? MembraneStress(triangles.rows(), Eigen::Matrix2d::Zero())
                                     : softened->stress(way.x, Points3::Zero(way.x.rows(), 3));
  const auto ways = !is_coarse()     ? NewtonOptions::both
                    : way.tries == 0 ? NewtonOptions::stride
                                     : NewtonOptions::descend;
  const NewtonReport newton = minimise(
      soft ? gentle : W,
      {options.stop, most, std::min(25, is_coarse() ? most : 2 * most / 3), ways}, stress, way.x);
  report.iterations += newton.iterations;
  way.converged = newton.converged;
  if (!way.converged && is_coarse() && ++way.tries < most_tries) return;
  way.leg = soft ? SecondWay::stiff : SecondWay::done;
  way.tries = 0;
}

void Elastic::Impl::second_way(const IncrementalPotential& W, const Points3& before,
                               const Points3& start, const Gripped& hard, Points3& x,
                               ElasticReport& report) {
  const auto passes = [&](const Points3& to) {
    return options.contact == SelfContact::automatic && !contact->clear(before, to, hard);
  };
  std::optional<SecondWay>& way = past.second;
  const bool leaves = report.iterations > restless || (is_coarse() && !report.converged);
  const bool begun_before = way.has_value();
  const int in_all = patience().in_all * options.max_iterations / usual_iterations;
  if (way) {
    way->x = predictor->guesses(way->x, {}, hard.targets).front();
    if (colliders) colliders->clear_way(way->x);
  } else if (!leaves || (report.converged && passes(x)))
    return;  // a shape that collides with itself is not where the sheet will stay
  else if (past.steps < past.content_until)
    return;
  else
    way = SecondWay{start};
  while (way->leg != SecondWay::done) {
    const int left = is_coarse() ? std::min(options.max_iterations, in_all - report.iterations)
                                 : options.max_iterations;
    if (left < std::min(options.max_iterations, worth_a_try)) return;
    go_on(*way, W, left, report);
  }
  const double here = W(x), there = W(way->x);
  if (!is_coarse() && past.remeshed && there > here - worth_having * std::abs(here))
    past.content_until = past.steps + content_for;
  if (there < here && !passes(way->x)) {
    report.lower_branch = (here - there) / std::max(std::abs(here), 1e-300);
    report.converged = way->converged;
    past.descending = false;
    x = std::move(way->x);
    way.reset();
  } else if (begun_before && leaves)
    way = SecondWay{start};  // starts again from where the main solution has got to
  else
    way.reset();
}

Held Elastic::Impl::reachable(const Sheet& sheet, const Held& held, double dt) {
  Held reached = held;
  if (!colliders) return reached;
  colliders->begin(sheet.x, held.colliders, {}, dt);
  colliders->clear_way(held.vertices, reached.targets);
  return reached;
}

SheetPotential Elastic::Impl::potential(const Sheet& sheet, double dt,
                                        std::vector<HandleSpring> springs) {
  const bool dynamic = options.inertia == Inertia::dynamic;
  const double inertia = (dynamic ? 1 : quasi_static_mass) / (dt * dt);
  return {*energy,
          mass,
          dynamic ? Points3(sheet.x + dt * sheet.v) : sheet.x,
          inertia,
          options.gravity,
          std::move(springs),
          colliders ? &*colliders : nullptr,
          block_of};
}

std::vector<Points3> Elastic::Impl::guesses(const Points3& before, const Gripped& hard,
                                            bool feels) {
  std::vector<Points3> all = predictor->guesses(before, past.positions, hard.targets);
  if (feels) {
    if (!past.positions.empty()) all.push_back(2 * before - past.positions[0]);
    all.push_back(before);
  }
  if (colliders)
    for (Points3& guess : all) colliders->clear_way(guess);
  return all;
}

void begin_at_best(const IncrementalPotential& W, const Points3& before,
                   std::vector<Points3>& guesses, Points3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (Points3& guess : guesses) {
    if (W.contact) {
      const Points3 move = guess - before;
      W.contact->cover(before, move);
      guess = before + W.contact->free_way(before, move) * move;
    }
    const double value = W(guess);
    if (value < least) least = value, x = guess;
  }
  if (!std::isfinite(least))
    throw Error(Fault::simulation, "elastic step", "The energy of the sheet is not finite.");
}

ElasticReport Elastic::Impl::solve(Sheet& sheet, const Held& handles, const Gripped& hard,
                                   double dt, Contact* feels, const NewtonOptions& how,
                                   SecondWays second) {
  const std::vector<HandleSpring> springs =
      handle_springs(handles, feels ? HardHandles::may_yield : HardHandles::are_held);
  if (feels) feels->begin(sheet.x, hard, dt);
  hold(sheet, feels ? std::vector<int>{} : hard.vertices, hard.vertices,
       feels ? feels->coupled_vertices(sheet.x) : std::vector<std::pair<int, int>>{});
  if (feels && matrix) feels->bind(*matrix, block_of);
  if (colliders)
    colliders->begin(sheet.x, handles.colliders, feels ? std::vector<int>{} : hard.vertices, dt,
                     feels ? hard : Gripped{});

  const Points3 before = sheet.x;
  const IncrementalPotential W{{potential(sheet, dt, springs)}, feels};
  std::vector<Points3> starts = guesses(before, hard, feels != nullptr);
  begin_at_best(W, before, starts, sheet.x);

  ElasticReport report;
  if (matrix) {
    MembraneStress stress = energy->stress(before, Points3::Zero(before.rows(), 3));
    // the stress is that of the change of mesh, not of an equilibrium
    if (past.remeshed) std::fill(stress.begin(), stress.end(), Eigen::Matrix2d::Zero());
    const NewtonReport newton = minimise(W, how, stress, sheet.x);
    report.iterations = newton.iterations;
    report.converged = newton.converged;
    if (second == SecondWays::where_restless) {
      past.descending = newton.descended && !newton.converged;
      if (!newton.in_vain) second_way(W, before, starts.front(), hard, sheet.x, report);
      report.leaving = past.descending || past.second;
    }
  }
  tell_held(sheet.x, feels ? springs : std::vector<HandleSpring>{}, report);
  if (feels) {
    feels->cover(sheet.x, Points3::Zero(sheet.x.rows(), 3));
    report.contact = true;
    report.touching = feels->active(sheet.x);
  }
  return report;
}

void Elastic::Impl::tell_held(const Points3& x, const std::vector<HandleSpring>& springs,
                              ElasticReport& report) {
  report.yielding = static_cast<int>(std::count_if(
      springs.begin(), springs.end(), [&](const HandleSpring& s) { return yields(s, x); }));
  if (!colliders) return;
  report.on_colliders = colliders->touching(x);
  report.inside = colliders->inside(x);
}

void Elastic::Impl::conclude(Sheet& sheet, const Points3& before, const Held& held, double dt,
                             ElasticReport& report) {
  constexpr double let_in = 5e-5;  // [m] depth inside a collider that is tolerated
  if (report.inside > let_in) {
    push_out(*options.colliders, held.colliders.to, Points3(sheet.x), -let_in, sheet.x);
    report.inside = colliders->inside(sheet.x);
  }
  past.remeshed = false;
  ++past.steps;
  const std::vector<double> folds = energy->fold_angles(sheet.x);
  report.plastic_flow = remember(folds);
  tell_stored(sheet.x, folds, report);
  sheet.v = (options.inertia == Inertia::dynamic ? std::pow(velocity_kept, 24 * dt) : 1.0) / dt *
            (sheet.x - before);
  past.positions.push_front(before);
  if (past.positions.size() > 2) past.positions.pop_back();
}

}  // namespace paperbake
