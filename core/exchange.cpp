#include "core/exchange.h"

#include "core/transfer.h"

#include <algorithm>

namespace paperbake {

Verdict exchange_mesh(Sheet& sheet, Elastic& elastic, Sheet proposal, const std::vector<double>& stiffening, const Held& held, double dt) {
  constexpr double most_rise = 0.05, most_move = 0.01;  // [1] of the energy; of the longer side
  constexpr double too_stiff = -0.005, most_move_then = 0.025;  // a mesh that holds its sheet back holds it the more, the longer it stays
  constexpr double noise = 1e-6;                        // [J] of a sheet that is nearly flat
  const Points3 carried = proposal.x;
  Elastic trial = elastic.on_mesh(proposal, stiffening);
  const ElasticReport settled = trial.settle(proposal, held, dt, Settling::briefly), stored = elastic.look(sheet);

  const Transfer onto(sheet.pattern, sheet.triangles, proposal.pattern), back(proposal.pattern, proposal.triangles, sheet.pattern);
  const double side = (sheet.pattern.colwise().maxCoeff() - sheet.pattern.colwise().minCoeff()).maxCoeff();
  const double rise = settled.potential - stored.potential;
  Verdict verdict;
  verdict.rise = rise / std::max(stored.energy, noise);
  verdict.move = std::max((proposal.x - carried).rowwise().norm().maxCoeff(), (back(proposal.x) - sheet.x).rowwise().norm().maxCoeff()) / side;
  verdict.accepted = settled.converged && !settled.contact && rise <= most_rise * stored.energy + noise && verdict.move <= (verdict.rise <= too_stiff ? most_move_then : most_move);
  if (!verdict.accepted) return verdict;
  // the past is moved along with the present, so that velocities are carried over and the jump of the exchange is none
  trial.continue_from(elastic, [&](const Points3& x) -> Points3 { return onto(x) + proposal.x - carried; });
  elastic = std::move(trial);
  sheet = std::move(proposal);
  return verdict;
}

}  // namespace paperbake
