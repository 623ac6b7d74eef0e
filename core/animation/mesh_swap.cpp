#include "core/animation/mesh_swap.h"

#include "core/geometry/measure.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/geometry/mesh_transfer.h"

#include <algorithm>

namespace paperbake {
namespace {

/// Relaxes a proposed sheet. Where that does not lead below `potential`, that of the sheet on its
/// old mesh, it may be in dents that come from there: it is relaxed from a softened membrane, too,
/// and has the lower shape in the end.
ElasticReport relax_proposal(Elastic& trial, Sheet& proposal, const StepInput& input, double dt,
                             double potential) {
  Sheet without_dents = proposal;
  const ElasticReport settled = trial.relax(proposal, input, dt, Relaxation::coarse);
  if (settled.converged && settled.potential <= potential) return settled;
  const ElasticReport softened = trial.relax(without_dents, input, dt, Relaxation::softened_first);
  const bool is_lower = !settled.converged || softened.potential < settled.potential;
  if (!softened.converged || softened.contact || softened.potential > potential || !is_lower)
    return settled;
  proposal.x = std::move(without_dents.x);
  return softened;
}

}  // namespace

MeshSwapResult try_swap_mesh(Sheet& sheet, Elastic& elastic, MeshProposal proposed,
                             const StepInput& input, double dt,
                             const AdmissibilityCheck& is_admissible) {
  constexpr double max_rise = 0.05, max_move = 0.01;  // [1] of the energy; of the longer side
  // a mesh that holds its sheet back does so the more, the longer it stays
  constexpr double too_stiff = -0.005, max_move_then = 0.025;
  // [1/rad2] share of the energy that a mesh of such flat triangles does not represent
  constexpr double unseen = 0.5;
  constexpr double instant = 0.01;  // [s]
  const double noise = energy_when_nearly_flat(elastic.paper());
  Sheet& proposal = proposed.sheet;
  const Points3 carried = proposal.x, velocities = proposal.v;
  Elastic trial = elastic.on_mesh(proposal, proposed.stiffening);
  if (trial.inertia() == Inertia::dynamic) {
    proposal.v.setZero();
    dt = instant;
  }
  const ElasticReport stored = elastic.evaluate_energies(sheet);
  const ElasticReport settled = relax_proposal(trial, proposal, input, dt, stored.potential);
  proposal.v = velocities;

  const MeshTransfer onto(sheet.pattern, sheet.triangles, proposal.pattern),
      back(proposal.pattern, proposal.triangles, sheet.pattern);
  const double side = longer_side(sheet.pattern);
  const double rise = settled.potential - stored.potential;
  MeshSwapResult verdict;
  verdict.rise = rise / std::max(stored.energy, noise);
  verdict.move =
      std::max(max_row_norm(proposal.x - carried), max_row_norm(back(proposal.x) - sheet.x)) / side;
  const double fold = mean_square_fold(sheet);
  const bool coarse = settled.on_colliders > 0 && fold > fold_that_holds,
             off = coarse || verdict.rise <= too_stiff;
  const double finer = coarse ? std::max(0.0, fold - mean_square_fold(proposal)) : 0;
  verdict.accepted = settled.converged && !settled.contact &&
                     rise <= (max_rise + unseen * finer) * stored.energy + noise &&
                     verdict.move <= (off ? max_move_then : max_move) &&
                     (!is_admissible || is_admissible(sheet, proposal, verdict.move * side));
  if (!verdict.accepted) return verdict;
  // Past positions are carried over, too, and displaced by what the swap itself moved: so
  // velocities stay, and the swap does not look like motion.
  trial.continue_from(elastic,
                      [&](const Points3& x) -> Points3 { return onto(x) + proposal.x - carried; });
  elastic = std::move(trial);
  sheet = std::move(proposal);
  return verdict;
}

}  // namespace paperbake
