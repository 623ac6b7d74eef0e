#include "core/exchange.h"

#include "core/transfer.h"

#include <algorithm>
#include <iterator>

namespace paperbake {

Verdict exchange_mesh(Sheet& sheet, Elastic& elastic, Sheet proposal, const std::vector<double>& stiffening, const Held& held, double dt) {
  struct Limit {
    double rise, noise, move;  // [1] of the energy, [J] of a sheet that is nearly flat, [1] of the longer side
  };
  constexpr Limit limits[] = {{0, 0, 0.015}, {0.05, 1e-6, 0.01}, {0.15, 0, 0.003}};
  constexpr double noise = 1e-6;       // [J] what a rise is at least compared with
  const Points3 carried = proposal.x;
  Elastic trial = elastic.on_mesh(proposal, stiffening);
  const ElasticReport settled = trial.settle(proposal, held, dt, Settling::briefly), stored = elastic.look(sheet);

  const Transfer onto(sheet.pattern, sheet.triangles, proposal.pattern), back(proposal.pattern, proposal.triangles, sheet.pattern);
  const double side = (sheet.pattern.colwise().maxCoeff() - sheet.pattern.colwise().minCoeff()).maxCoeff();
  const double rise = settled.potential - stored.potential;
  Verdict verdict;
  verdict.rise = rise / std::max(stored.energy, noise);
  verdict.move = std::max((proposal.x - carried).rowwise().norm().maxCoeff(), (back(proposal.x) - sheet.x).rowwise().norm().maxCoeff()) / side;
  verdict.accepted = settled.converged && !settled.contact && std::any_of(std::begin(limits), std::end(limits), [&](const Limit& limit) {
    return rise <= limit.rise * stored.energy + limit.noise && verdict.move <= limit.move;
  });
  if (!verdict.accepted) return verdict;
  // the past is moved along with the present, so that velocities are carried over and the jump of the exchange is none
  trial.continue_from(elastic, [&](const Points3& x) -> Points3 { return onto(x) + proposal.x - carried; });
  elastic = std::move(trial);
  sheet = std::move(proposal);
  return verdict;
}

}  // namespace paperbake
