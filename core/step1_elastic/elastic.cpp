#include "core/step1_elastic/elastic.h"

#include "core/error.h"
#include "core/measure.h"
#include "core/step1_elastic/contact.h"
#include "core/step1_elastic/elastic_energy.h"
#include "core/step1_elastic/handle_springs.h"
#include "core/step1_elastic/predictor.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

namespace paperbake {
namespace {

constexpr double quasi_static_mass = 0.01;  // share of the true mass; 1 ... 1e-5 give the same shapes to 4 digits
constexpr double velocity_kept = 0.98;
constexpr double sufficient_decrease = 1e-4;
constexpr int max_halvings = 30;

// A step that needs more iterations than this leaves an unstable shape, and the nearest minimum may be a poor one.
constexpr int restless = 15;
constexpr double jam_stretch = 0.01;  // [1] of an edge: paper tears before; what holds it gives way
constexpr double softening = 100;  // of the membrane: its landscape has few valleys

/// The incremental potential of one step over all vertices; held ones are left out by whoever solves.
struct IncrementalPotential {
  const ElasticEnergy& elastic;
  const Eigen::VectorXd& mass;  // [kg] of the vertices
  Points3 xhat;
  double inertia;               // [1/s2] factor on the mass
  double gravity;
  const std::vector<HandleSpring>& springs;
  Contact* contact;             // null: the sheet does not feel itself

  double operator()(const Points3& x) const {
    double value = elastic.energy(x) + inertia_and_weight(x);
    if (!springs.empty()) value += energy(springs, x);
    if (contact) value += contact->energy(x);
    return value;
  }

  double inertia_and_weight(const Points3& x) const {
    return mass.dot(0.5 * inertia * (x - xhat).rowwise().squaredNorm() + gravity * x.col(2));
  }

  void add_inertia_and_weight(const Points3& x, Points3& gradient) const {
    for (int v = 0; v < x.rows(); ++v)
      gradient.row(v) += mass[v] * (inertia * (x.row(v) - xhat.row(v)) + gravity * Eigen::RowVector3d::UnitZ());
  }

  /// Value; gradient |V|x3 overwritten; second derivative into the matrix.
  double differentiate(const Points3& x, const std::vector<int>& block_of, HessianForm form, Points3& gradient,
                       BlockCholesky& matrix) const {
    matrix.set_zero();
    double value = elastic.hessian(x, form, gradient, matrix) + inertia_and_weight(x);
    add_inertia_and_weight(x, gradient);
    if (!springs.empty()) value += paperbake::differentiate(springs, x, block_of, gradient, matrix);
    if (contact) value += contact->differentiate(x, gradient, &matrix);
    for (int v = 0; v < x.rows(); ++v)
      matrix.add(matrix.slot(block_of[v], block_of[v]), Matrix3(mass[v] * inertia * Matrix3::Identity()));
    return value;
  }
};

double largest_row(const Points3& d) { return d.rows() ? std::sqrt(d.rowwise().squaredNorm().maxCoeff()) : 0; }

}  // namespace

struct Elastic::Impl {
  Paper paper;
  ElasticOptions options;

  std::optional<ElasticEnergy> energy, softened;
  Eigen::VectorXd mass;
  double mean_edge = 0;
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

  /// Newton's direction at x; falls back to the projected second derivative, then to a growing multiple of the identity.
  Points3 direction(const IncrementalPotential& W, const Points3& x, HessianForm& form, double& value, Points3& gradient) {
    for (;; form = HessianForm::projected) {
      value = W.differentiate(x, block_of, form, gradient, *matrix);
      if (!std::isfinite(value)) throw Error(Fault::simulation, "elastic step", "The energy of the sheet is not finite.");
      bool definite = matrix->factorise();
      if (!definite && form == HessianForm::exact) continue;
      for (double shift = 1e-8 * paper.membrane_stiffness; !definite; shift *= 100) {
        matrix->shift_diagonal(shift);
        definite = matrix->factorise();
      }
      Points3 move = downhill(gradient);
      if (form == HessianForm::exact && gradient.cwiseProduct(move).sum() >= 0) continue;
      return move;
    }
  }

  /// The last factor's answer to a gradient; held vertices stay.
  Points3 downhill(const Points3& gradient) {
    Eigen::VectorXd right(3 * (gradient.rows() - static_cast<int>(held.size())));
    for (int v = 0; v < gradient.rows(); ++v)
      if (block_of[v] >= 0) right.segment<3>(3 * block_of[v]) = -gradient.row(v).transpose();
    const Eigen::VectorXd& d = matrix->solve(right);
    Points3 move = Points3::Zero(gradient.rows(), 3);
    for (int v = 0; v < gradient.rows(); ++v)
      if (block_of[v] >= 0) move.row(v) = d.segment<3>(3 * block_of[v]).transpose();
    return move;
  }

  /// Length along `move` that lowers W enough; 0 when there is none.
  static double line_search(const IncrementalPotential& W, const Points3& x, const Points3& move, double value, double slope) {
    // below the rounding of W itself nothing can be compared: a full step is as good as any
    if (-slope < 1e-13 * std::abs(value)) return 1;
    double length = 1;
    for (int k = 0; k < max_halvings; ++k, length *= 0.5)
      if (W(x + length * move) <= value + sufficient_decrease * length * slope) return length;
    return 0;
  }

  void minimise(const IncrementalPotential& W, Points3& x, ElasticReport& report) {
    const double longest_move = W.contact ? std::min(2 * mean_edge, 2.5 * W.contact->reach()) : 2 * mean_edge;
    if (W.contact) W.contact->cover(x, Points3::Zero(x.rows(), 3));
    double last = 0;
    report.converged = false;
    HessianForm form = HessianForm::exact;
    Points3 gradient;
    while (report.iterations < options.max_iterations) {
      double value;
      Points3 move = direction(W, x, form, value, gradient);
      ++report.iterations;
      const double asked = largest_row(move);
      if (asked > longest_move) move *= longest_move / asked;
      double free = 1;
      if (W.contact) {
        W.contact->cover(x, move);
        free = W.contact->free_way(x, move);
        if (free < 1) move *= free;
      }
      const double slope = gradient.cwiseProduct(move).sum();
      const double length = line_search(W, x, move, value, slope);
      if (length == 0) {
        if (asked < options.stop || form == HessianForm::projected) {
          report.converged = asked < options.stop;
          return;
        }
        form = HessianForm::projected;
        continue;
      }
      x += length * move;
      if (W.contact) W.contact->arrived(x);
      const double done = length * free * std::min(asked, longest_move);
      // Newton's steps shrink at least as fast as their last ratio: the next one bounds the distance to the minimum
      const bool whole = length == 1 && free == 1 && asked <= longest_move;
      const double ahead = last > 0 ? done * std::min(1.0, done / last) : done;
      if (whole && (ahead < options.stop || done < options.stop)) {
        report.converged = true;
        return;
      }
      last = whole ? done : 0;
      form = HessianForm::exact;
    }
  }

  /// A second way down from `start`, first with the softened membrane; kept when it ends lower.
  void start_again(const IncrementalPotential& W, const Points3& start, Points3& x, ElasticReport& report) {
    ElasticReport soft, stiff;
    Points3 other = start;
    minimise({*softened, mass, W.xhat, W.inertia, W.gravity, W.springs, nullptr}, other, soft);
    minimise(W, other, stiff);
    report.iterations += soft.iterations + stiff.iterations;
    const double here = W(x), there = W(other);
    if (there >= here) return;
    report.lower_branch = (here - there) / std::max(std::abs(here), 1e-300);
    report.converged = stiff.converged;
    x = std::move(other);
  }

  /// One step; `feels` is null for a sheet that does not feel itself.
  ElasticReport solve(Sheet& sheet, const Held& handles, const Gripped& hard, double dt, Contact* feels) {
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
    if (matrix) minimise(W, sheet.x, report);
    // beside itself the softened sheet soon meets its own parts: a second start finds nothing better there
    if (report.iterations > restless && !feels) start_again(W, guesses.front(), sheet.x, report);
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

void Elastic::set_mesh(const Sheet& sheet, const std::vector<double>& stiffening) {
  Impl& s = *impl_;
  s.energy.emplace(s.paper, sheet.pattern, sheet.triangles, stiffening);
  Paper soft = s.paper;
  soft.membrane_stiffness /= softening;
  s.softened.emplace(soft, sheet.pattern, sheet.triangles, stiffening);
  s.matrix.reset();
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
  return report;
}

ElasticReport Elastic::step(Sheet& sheet, const Held& held, double dt) {
  Impl& s = *impl_;
  const bool dynamic = s.options.inertia == Inertia::dynamic;
  const Points3 before = sheet.x;
  Gripped hard = hard_handles(held);
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
  report.plastic_flow = s.remember(sheet.x);
  const ElasticReport stored = look(sheet);
  report.membrane = stored.membrane;
  report.energy = stored.energy;

  sheet.v = (dynamic ? velocity_kept : 1.0) / dt * (sheet.x - before);
  s.past.push_front(before);
  if (s.past.size() > 2) s.past.pop_back();
  return report;
}

}  // namespace paperbake
