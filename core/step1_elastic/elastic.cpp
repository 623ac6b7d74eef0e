#include "core/step1_elastic/elastic.h"

#include "core/error.h"
#include "core/measure.h"
#include "core/step1_elastic/elastic_energy.h"
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
constexpr double softening = 100;  // of the membrane: its landscape has few valleys

/// The incremental potential of one step over all vertices; held ones are left out by whoever solves.
struct IncrementalPotential {
  const ElasticEnergy& elastic;
  const Eigen::VectorXd& mass;  // [kg] of the vertices
  Points3 xhat;
  double inertia;               // [1/s2] factor on the mass
  double gravity;

  double operator()(const Points3& x) const { return elastic.energy(x) + inertia_and_weight(x); }

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
    const double value = elastic.hessian(x, form, gradient, matrix) + inertia_and_weight(x);
    add_inertia_and_weight(x, gradient);
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

  // belongs to the mesh and the set of held vertices
  std::vector<int> held;
  std::vector<int> block_of;
  std::unique_ptr<BlockCholesky> matrix;
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

  void hold(const Sheet& sheet, const std::vector<int>& vertices) {
    if (matrix && vertices == held) return;
    held = vertices;
    block_of.assign(sheet.x.rows(), 0);
    for (int v : held) block_of[v] = -1;
    int blocks = 0;
    for (int& b : block_of)
      if (b == 0) b = blocks++;
    std::vector<std::pair<int, int>> coupled;
    for (const auto& [i, j] : energy->coupled_vertices())
      if (block_of[i] >= 0 && block_of[j] >= 0) coupled.emplace_back(block_of[i], block_of[j]);
    matrix = blocks ? std::make_unique<BlockCholesky>(blocks, std::move(coupled)) : nullptr;
    if (matrix) energy->bind(*matrix, block_of), softened->bind(*matrix, block_of);
    predictor = std::make_unique<Predictor>(sheet.pattern, sheet.triangles, held);
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
    const double longest_move = 2 * mean_edge;
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
      const double done = length * std::min(asked, longest_move);
      // Newton's steps shrink at least as fast as their last ratio: the next one bounds the distance to the minimum
      const bool whole = length == 1 && asked <= longest_move;
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
    minimise({*softened, mass, W.xhat, W.inertia, W.gravity}, other, soft);
    minimise(W, other, stiff);
    report.iterations += soft.iterations + stiff.iterations;
    const double here = W(x), there = W(other);
    if (there >= here) return;
    report.lower_branch = (here - there) / std::max(std::abs(here), 1e-300);
    report.converged = stiff.converged;
    x = std::move(other);
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
  s.hold(sheet, held.vertices);
  sheet.x = s.predictor->guesses(sheet.x, {}, held.targets).front();
  ElasticReport report;
  const double inertia = (s.options.inertia == Inertia::dynamic ? 1 : quasi_static_mass) / (dt * dt);
  constexpr double coarser = 10;  // the next step goes on from here
  const ElasticOptions usual = s.options;
  s.options.max_iterations = std::min(usual.max_iterations, most_iterations);
  s.options.stop *= coarser;
  if (s.matrix) s.minimise({*s.energy, s.mass, sheet.x, inertia, s.options.gravity}, sheet.x, report);
  s.options = usual;
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
  s.hold(sheet, held.vertices);
  const bool dynamic = s.options.inertia == Inertia::dynamic;
  const Points3 before = sheet.x;
  const IncrementalPotential W{*s.energy, s.mass, dynamic ? Points3(before + dt * sheet.v) : before,
                               (dynamic ? 1 : quasi_static_mass) / (dt * dt), s.options.gravity};

  // start from the guess of least potential
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Points3> guesses = s.predictor->guesses(before, s.past, held.targets);
  for (const Points3& guess : guesses) {
    const double value = W(guess);
    if (value < least) least = value, sheet.x = guess;
  }
  if (!std::isfinite(least)) throw Error(Fault::simulation, "elastic step", "The energy of the sheet is not finite.");

  ElasticReport report;
  if (s.matrix) s.minimise(W, sheet.x, report);
  if (report.iterations > restless) s.start_again(W, guesses.front(), sheet.x, report);
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
