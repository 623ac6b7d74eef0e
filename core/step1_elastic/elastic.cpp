#include "core/step1_elastic/elastic.h"

#include "core/error.h"
#include "core/measure.h"
#include "core/step1_elastic/contact.h"
#include "core/step1_elastic/elastic_energy.h"
#include "core/step1_elastic/handle_springs.h"
#include "core/step1_elastic/newton.h"
#include "core/step1_elastic/predictor.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

namespace paperbake {
namespace {

constexpr double quasi_static_mass = 0.01;  // share of the true mass; 1 ... 1e-5 give the same shapes to 4 digits
constexpr double velocity_kept = 0.98;

// A step that needs more iterations than this leaves an unstable shape, and the nearest minimum may be a poor one.
constexpr int restless = 15;

// A sheet that pushes itself has no end of small moves: what is not finished goes on in the next frame.
constexpr int most_iterations_in_touch = 20;

constexpr double jam_stretch = 0.01;  // [1] of an edge: paper tears before; what holds it gives way
constexpr double softening = 100;  // of the membrane: its landscape has few valleys

enum class SecondStart { when_restless, never };

}  // namespace

struct Elastic::Impl {
  Paper paper;
  ElasticOptions options;

  std::optional<ElasticEnergy> energy, softened;
  Eigen::VectorXd mass;
  double mean_edge = 0;
  bool remeshed = true;      // since the last step
  std::deque<Points3> past;  // positions before this step, newest first; emptied when the number of vertices changes
  PlasticGrid* grid = nullptr;
  Points2 pattern;
  Triangles triangles;
  PlasticGrid::Cover cover;  // of the grid by the triangles

  std::optional<Contact> contact;
  bool careful = false;      // the last step ended with parts touching, or with handles that the paper does not follow

  // belongs to the mesh and the set of held vertices
  std::vector<int> held;     // left out of the solve
  std::vector<int> guided;   // taken along by the predictor
  std::vector<int> block_of;
  std::unique_ptr<BlockCholesky> matrix;
  bool matrix_of_contact = false;
  std::unique_ptr<Predictor> predictor;

  void recall() { energy->memory = softened->memory = grid ? grid->read(cover) : PlasticMemory{}; }

  void find_cover() {
    if (grid) cover = grid->cover(pattern, triangles);
    recall();
  }

  /// Where the sheet bends in two directions as a step begins, it yields as ridges do.
  void look_for_ridges(const Sheet& sheet, const std::vector<int>& vertices) {
    if (grid) energy->ridges = softened->ridges = find_ridges(sheet, paper, vertices, energy->memory.ridge);
  }

  /// What has flowed goes to the grid and comes back as the past of the next step. returns the growth of the integral [m rad]
  double remember(const Points3& x) {
    if (!grid) return 0;
    const double growth = grid->write(cover, energy->gained(x));
    recall();
    return growth;
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

  /// stress  of the membrane where x came from
  NewtonReport minimise(const IncrementalPotential& W, const MembraneStress& stress, Points3& x) {
    const int most = W.contact ? std::min(options.max_iterations, most_iterations_in_touch) : options.max_iterations;
    return paperbake::minimise({W, *matrix, block_of, mean_edge, paper.membrane_stiffness}, {options.stop, most}, stress, x);
  }

  /// A second way down from `start`, first with the softened membrane; kept when it ends lower.
  void start_again(const IncrementalPotential& W, const Points3& start, Points3& x, ElasticReport& report) {
    Points3 other = start;
    const MembraneStress none(triangles.rows(), Eigen::Matrix2d::Zero());
    const NewtonReport soft = minimise({*softened, mass, W.xhat, W.inertia, W.gravity, W.springs, nullptr}, none, other);
    const NewtonReport stiff = minimise(W, softened->stress(other, Points3::Zero(other.rows(), 3)), other);
    report.iterations += soft.iterations + stiff.iterations;
    const double here = W(x), there = W(other);
    if (there >= here) return;
    report.lower_branch = (here - there) / std::max(std::abs(here), 1e-300);
    report.converged = stiff.converged;
    x = std::move(other);
  }

  /// One step; `feels` is null for a sheet that does not feel itself.
  ElasticReport solve(Sheet& sheet, const Held& handles, const Gripped& hard, double dt, Contact* feels,
                      SecondStart second = SecondStart::when_restless) {
    const std::vector<HandleSpring> springs = handle_springs(handles, feels ? HardHandles::may_yield : HardHandles::are_held);
    if (feels) feels->begin(sheet.x, hard);
    hold(sheet, feels ? std::vector<int>{} : hard.vertices, hard.vertices,
         feels ? feels->coupled_vertices(sheet.x) : std::vector<std::pair<int, int>>{});
    if (feels && matrix) feels->bind(*matrix, block_of);

    const bool dynamic = options.inertia == Inertia::dynamic;
    const Points3 before = sheet.x;
    const IncrementalPotential W{*energy, mass, dynamic ? Points3(before + dt * sheet.v) : before,
                                 (dynamic ? 1 : quasi_static_mass) / (dt * dt), options.gravity, springs, feels};

    // start from the guess of least potential
    double least = std::numeric_limits<double>::infinity();
    std::vector<Points3> guesses = predictor->guesses(before, past, hard.targets);
    if (feels) {  // where handles lag behind, they need not jump
      if (!past.empty()) guesses.push_back(2 * before - past[0]);
      guesses.push_back(before);
    }
    for (Points3& guess : guesses) {
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
      if (remeshed) std::fill(stress.begin(), stress.end(), Eigen::Matrix2d::Zero());  // not in equilibrium: what the mesh did
      const NewtonReport newton = minimise(W, stress, sheet.x);
      report.iterations = newton.iterations;
      report.converged = newton.converged;
    }
    // beside itself the softened sheet soon meets its own parts: a second start finds nothing better there
    if (second == SecondStart::when_restless && report.iterations > restless && !feels) start_again(W, guesses.front(), sheet.x, report);
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
  s.energy.emplace(s.paper, sheet.pattern, sheet.triangles, stiffening);
  Paper soft = s.paper;
  soft.membrane_stiffness /= softening;
  s.softened.emplace(soft, sheet.pattern, sheet.triangles, stiffening);
  s.matrix.reset();
  s.remeshed = true;
  s.predictor.reset();
  if (s.options.contact == SelfContact::automatic) s.contact.emplace(sheet.pattern, sheet.triangles);
  if (!s.past.empty() && s.past.front().rows() != sheet.pattern.rows()) s.past.clear();
  s.pattern = sheet.pattern;
  s.triangles = sheet.triangles;
  s.find_cover();
  s.mass = Eigen::VectorXd::Zero(sheet.pattern.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const double area = rest_triangle(sheet.pattern, sheet.triangles.row(t)).area;
    for (int i = 0; i < 3; ++i) s.mass[sheet.triangles(t, i)] += s.paper.area_density * area / 3;
  }
  s.mean_edge = mean_edge(sheet.pattern, sheet.triangles);
}

void Elastic::remember_in(PlasticGrid* grid) {
  impl_->grid = grid;
  if (impl_->energy) impl_->find_cover();
}

ElasticReport Elastic::look(const Sheet& sheet) const {
  const ElasticEnergy::Parts parts = impl_->energy->parts(sheet.x);
  ElasticReport report;
  report.membrane = parts.membrane;
  report.energy = parts.membrane + parts.bending;
  report.potential = report.energy + impl_->options.gravity * impl_->mass.dot(sheet.x.col(2));
  return report;
}

ElasticReport Elastic::settle(Sheet& sheet, const Held& held, double dt, int most_iterations) {
  Impl& s = *impl_;
  const Points3 before = sheet.x;
  const Gripped hard = hard_handles(held);
  constexpr double coarser = 10;  // the next step goes on from here
  const ElasticOptions usual = s.options;
  s.options.max_iterations = std::min(usual.max_iterations, most_iterations);
  s.options.stop *= coarser;
  ElasticReport report = s.solve(sheet, held, hard, dt, nullptr, SecondStart::never);
  s.options = usual;
  if (s.contact && !s.contact->clear(before, sheet.x, hard)) report.converged = false;  // not the same sheet: it passes through itself
  const ElasticReport stored = look(sheet);
  report.energy = stored.energy;
  report.membrane = stored.membrane;
  report.potential = stored.potential;
  return report;
}

Elastic Elastic::on_mesh(const Sheet& sheet, const std::vector<double>& stiffening) const {
  Elastic other(impl_->paper, impl_->options);
  other.remember_in(impl_->grid);
  other.set_mesh(sheet, stiffening);
  return other;
}

void Elastic::continue_from(const Elastic& other, const std::function<Points3(const Points3&)>& carried) {
  impl_->past.clear();
  for (const Points3& x : other.impl_->past) impl_->past.push_back(carried(x));
}

ElasticReport Elastic::step(Sheet& sheet, const Held& held, double dt) {
  Impl& s = *impl_;
  const bool dynamic = s.options.inertia == Inertia::dynamic;
  const Points3 before = sheet.x;
  Gripped hard = hard_handles(held);
  s.look_for_ridges(sheet, held.vertices);
  ElasticReport report;
  const bool may_touch = s.options.contact == SelfContact::automatic;
  if (!may_touch || !s.careful) report = s.solve(sheet, held, hard, dt, nullptr);
  if (may_touch && (s.careful || (s.matrix && largest_stretch(sheet) > jam_stretch) || !s.contact->clear(before, sheet.x, hard))) {
    const int in_vain = report.iterations;
    sheet.x = before;
    report = s.solve(sheet, held, hard, dt, &*s.contact);
    report.iterations += in_vain;
    s.careful = report.touching > 0 || report.yielding > 0;
  }
  s.remeshed = false;
  report.plastic_flow = s.remember(sheet.x);
  const ElasticReport stored = look(sheet);
  report.membrane = stored.membrane;
  report.energy = stored.energy;
  report.potential = stored.potential;

  sheet.v = (dynamic ? velocity_kept : 1.0) / dt * (sheet.x - before);
  s.past.push_front(before);
  if (s.past.size() > 2) s.past.pop_back();
  return report;
}

}  // namespace paperbake
