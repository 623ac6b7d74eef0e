#pragma once

#include "core/step1_elastic/elastic.h"

#include <vector>

namespace paperbake {

struct MeshSwapResult {
  bool accepted = false;
  double rise = 0;  // [1] of the potential, as a share of the energy that was stored
  // [1] of the longer side: farthest that a vertex of either mesh lies from the other surface
  double move = 0;
};

/// Puts a sheet on another mesh of its pattern, if it stays the same sheet. The proposal is relaxed
/// with the handles where they are, and taken when that ends at a minimum, the potential rises by
/// no more than 5 % of the energy that is stored + 1e-6 J, and nothing moves farther than 1 %; 2.5
/// % where the energy falls by half a percent or more: the old mesh is too stiff there, and the
/// longer it stays, the farther is the way. The same holds for a sheet that lies on a collider and
/// turns by 20 degrees and more from facet to facet: the energy may rise there by half of what the
/// mean square of the folds falls. With it comes a solver that remembers the past of the old one,
/// carried over. Nothing flows. Refused, a proposal leaves no trace.
/// proposal    the sheet on its new mesh, positions and velocities carried over
/// stiffening  as in Elastic::set_mesh, of the new mesh
/// held        vertices of the new mesh, at the positions of the old one
/// fits        asked last: may the sheet go there, some way [m] off? empty: it may
MeshSwapResult try_swap_mesh(Sheet&, Elastic&, Sheet proposal,
                             const std::vector<double>& stiffening, const PositionConstraints& held,
                             double dt,
                             const std::function<bool(const Sheet& here, const Sheet& there,
                                                      double moved)>& is_admissible = {});

}  // namespace paperbake
