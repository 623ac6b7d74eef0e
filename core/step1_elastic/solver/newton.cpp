#include "core/step1_elastic/solver/newton.h"

#include "core/geometry/measure.h"
#include "core/step1_elastic/energy_not_finite.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double sufficient_decrease = 1e-4;  // [1] of what the slope promises [Armijo 1966]
constexpr int max_halvings = 30;
// [1] of W: a decrease below its rounding error cannot be measured
constexpr double rounding_of_potential = 1e-13;
// How far a vertex may go in one iteration, all assumed: a triangle is not turned inside out by two
// edge lengths, nor does a search for pairs in contact have to reach far for ten contact distances.
constexpr double most_edges = 2, most_contact_distances = 10;  // [1]
// [1] of the membrane stiffness: what is first added to the diagonal of a Hessian that is not
// positive definite, and the factor by which it grows until it is
constexpr double first_shift = 1e-8, shift_growth = 100;
// A barrier has kinks where the closest points jump from one feature to another, as they do between
// parallel edges of layers that lie on each other. At a minimum in a kink no step goes its whole
// length: what several exact steps in a row ask for has to do.
constexpr double near_share = 0.25;  // [1] of the tolerance
constexpr int near_in_a_row = 3;
constexpr int asked_every = 4;  // [1] iterations between two calls of should_abort

/// One minimisation.
class Newton {
 public:
  Newton(const NewtonSystem& system, const NewtonOptions& options)
      : W_(system.W),
        matrix_(system.matrix),
        block_of_(system.block_of),
        mean_edge_(system.mean_edge),
        membrane_stiffness_(system.membrane_stiffness),
        options_(options),
        max_move_(most_edges * mean_edge_) {
    if (W_.contact) max_move_ = std::min(max_move_, most_contact_distances * W_.contact->dhat());
  }

  /// The first variant. stress: of the membrane before the first iteration
  /// returns  false if it did not converge to an acceptable minimum; x is then arbitrary
  bool mixed_newton(MembraneStress stress, Points3& x);

  /// The second variant.
  void line_search_newton(Points3& x);

  NewtonReport report;

 private:
  Points3 direction(const Points3& x, HessianForm& form, const MembraneStress* stress);
  Points3 downhill() const;
  double line_search(const Points3& x, const Points3& move) const;

  /// W at positions for which contact may not know the candidate pairs yet.
  double covered(const Points3& x) const {
    if (W_.contact) W_.contact->update_candidates(x, Points3::Zero(x.rows(), 3));
    return W_(x);
  }
  bool should_abort(int iteration, const Points3& x) {
    return report.aborted = options_.should_abort && iteration > 0 &&
                            iteration % asked_every == 0 && options_.should_abort(x);
  }
  void go(Points3& x, const Points3& move) const {
    x += move;
    if (W_.contact) W_.contact->commit_step(x);
  }
  double largest_strain(const MembraneStress& stress) const {
    double most = 0;
    for (const Eigen::Matrix2d& s : stress) most = std::max(most, s.norm() / membrane_stiffness_);
    return most;
  }

  const IncrementalPotential& W_;
  BlockCholesky& matrix_;
  const std::vector<int>& block_of_;
  double mean_edge_, membrane_stiffness_;
  NewtonOptions options_;
  double max_move_;   // [m] of a vertex in one iteration
  double value_ = 0;  // W where it was differentiated last
  Points3 gradient_;
};

/// Newton's direction at x. Falls back to the projected Hessian, then to adding a growing multiple
/// of the identity.
Points3 Newton::direction(const Points3& x, HessianForm& form, const MembraneStress* stress) {
  ++report.iterations;
  for (;; form = HessianForm::projected) {
    value_ = W_.differentiate(x, form, gradient_, matrix_, stress);
    if (!std::isfinite(value_)) throw EnergyNotFinite();
    bool definite = matrix_.factorise();
    if (!definite && form == HessianForm::exact) continue;
    for (double shift = first_shift * membrane_stiffness_; !definite; shift *= shift_growth) {
      if (!std::isfinite(shift)) throw EnergyNotFinite();  // nor is the Hessian
      matrix_.shift_diagonal(shift);
      definite = matrix_.factorise();
    }
    Points3 move = downhill();
    if (form == HessianForm::exact && gradient_.cwiseProduct(move).sum() >= 0) continue;
    return move;
  }
}

/// Solves for the negative gradient with the last factor; constrained vertices do not move.
Points3 Newton::downhill() const {
  const long free = std::count_if(block_of_.begin(), block_of_.end(), [](int b) { return b >= 0; });
  Eigen::VectorXd right(3 * free);
  for (int v = 0; v < gradient_.rows(); ++v)
    if (block_of_[v] >= 0) right.segment<3>(3 * block_of_[v]) = -gradient_.row(v).transpose();
  const Eigen::VectorXd& d = matrix_.solve(right);
  Points3 move = Points3::Zero(gradient_.rows(), 3);
  for (int v = 0; v < gradient_.rows(); ++v)
    if (block_of_[v] >= 0) move.row(v) = d.segment<3>(3 * block_of_[v]).transpose();
  return move;
}

/// Fraction of `move` that decreases W sufficiently; 0 if there is none.
double Newton::line_search(const Points3& x, const Points3& move) const {
  const double slope = gradient_.cwiseProduct(move).sum();
  // where nothing can be measured the full step is as good as any
  if (-slope < rounding_of_potential * std::abs(value_)) return 1;
  double length = 1;
  for (int k = 0; k < max_halvings; ++k, length *= 0.5)
    if (W_(x + length * move) <= value_ + sufficient_decrease * length * slope) return length;
  return 0;
}

bool Newton::mixed_newton(MembraneStress stress, Points3& x) {
  // the crest between two valleys: line-search Newton is as slow there, but it does get down. All
  // assumed.
  constexpr int max_crawling = 8;        // [1] iterations in a row
  constexpr double not_shrunk = 0.5;     // [1] of the step before
  constexpr double crawling_step = 0.1;  // [1] of an edge
  constexpr double torn = 0.005;         // [1] strain beyond which line-search Newton does better
  const double first_value = covered(x), first_strain = largest_strain(stress);
  double last = 0;
  int crawling = 0;
  for (int k = 0; k < options_.max_mixed_newton; ++k) {
    if (options_.ways == NewtonOptions::mixed_newton && should_abort(k, x)) return false;
    HessianForm form = HessianForm::exact;
    Points3 move = direction(x, form, &stress);
    const double asked = max_row_norm(move);
    if (asked > max_move_) move *= max_move_ / asked;
    const double free = W_.limit_step(x, move);
    stress = W_.sheets.front().elastic.stress(x, move);
    go(x, move);
    // steps shrink at least by their last ratio, so the next step bounds the distance to the
    // minimum
    const double ahead = last > 0 ? asked * std::min(1.0, asked / last) : asked;
    if (free == 1 &&
        (asked < options_.stop || (form == HessianForm::exact && ahead < options_.stop))) {
      report.converged =
          covered(x) <= first_value && largest_strain(stress) < std::max(torn, 2 * first_strain);
      return report.converged;
    }
    const bool crawls = form == HessianForm::projected && asked > not_shrunk * last &&
                        asked < crawling_step * mean_edge_;
    crawling = crawls ? crawling + 1 : 0;
    if (crawling == max_crawling) return false;
    last = asked;
  }
  return false;
}

void Newton::line_search_newton(Points3& x) {
  covered(x);
  double last = 0, before_last = 0;
  int near = 0;  // [1] iterations in a row that asked for next to nothing
  report.converged = false;
  HessianForm form = HessianForm::exact;
  report.descended = true;
  for (int k = 1; report.iterations < options_.max_iterations; ++k) {
    if (should_abort(k, x)) return;
    Points3 move = direction(x, form, nullptr);
    const double asked = max_row_norm(move);
    if (asked > max_move_) move *= max_move_ / asked;
    const double free = W_.limit_step(x, move);
    const double length = line_search(x, move);
    near = form == HessianForm::exact && asked < near_share * options_.stop ? near + 1 : 0;
    if (near == near_in_a_row) {
      report.converged = true;
      return;
    }
    if (length == 0) {
      if (asked < options_.stop || form == HessianForm::projected) {
        report.converged = asked < options_.stop;
        return;
      }
      form = HessianForm::projected;
      continue;
    }
    go(x, length * move);
    const double done = length * free * std::min(asked, max_move_);
    const bool whole = length == 1 && free == 1 && asked <= max_move_;
    const double ahead = last > 0 ? done * std::min(1.0, done / last) : done;
    // Between barriers steps alternate between long and short, and those of the projected Hessian
    // are too short: there, steps have to shrink twice.
    const bool trusted = !W_.contact || (form == HessianForm::exact && before_last > 0 &&
                                         last < before_last && done < last);
    // Steps of the projected Hessian that shrink by the same ratio have a sum.
    const bool shrinks = whole && before_last > 0 && last < before_last && done < last;
    const bool sum_is_small = shrinks && done * done < options_.stop * (last - done);
    if (sum_is_small || (whole && trusted && (ahead < options_.stop || done < options_.stop))) {
      report.converged = true;
      return;
    }
    before_last = whole ? last : 0;
    last = whole ? done : 0;
    form = HessianForm::exact;
  }
}

}  // namespace

NewtonReport minimise(const NewtonSystem& system, const NewtonOptions& options,
                      const MembraneStress& stress, Points3& x) {
  Newton newton(system, options);
  const Points3 start = x;
  // between barriers the long steps of mixed Newton are shortened before they get anywhere
  if (!system.W.contact && options.ways != NewtonOptions::line_search_newton &&
      newton.mixed_newton(stress, x))
    return newton.report;
  x = start;
  if (options.ways == NewtonOptions::mixed_newton) return newton.report;
  newton.line_search_newton(x);
  return newton.report;
}

}  // namespace paperbake
