#pragma once

#include "core/step1_elastic/elastic.h"

#include <vector>

namespace paperbake {

/// Asked before a sheet is replaced by one on another mesh or on another branch: may it be?
/// moved  [m] largest displacement
using AdmissibilityCheck = std::function<bool(const Sheet& here, const Sheet& there, double moved)>;

struct MeshProposal {
  Sheet sheet;                     // on its new mesh, positions and velocities carried over
  std::vector<double> stiffening;  // as in Elastic::set_mesh, of the new mesh
};

struct MeshSwapResult {
  bool accepted = false;
  double rise = 0;  // [1] of the potential, as a share of the stored energy
  // [1] of the longer side: largest distance of a vertex of either mesh from the other surface
  double move = 0;
};

/// Replaces the mesh of a sheet by a proposed one, provided that the sheet stays the same sheet.
/// The proposal is relaxed with the handles where they are. It is accepted when the relaxation
/// converges without the sheet coming near itself, the potential rises by no more than 5 % of the
/// stored energy and what a nearly flat sheet stores (paper.h), and nothing moves farther than 1 %
/// of the longer side. There are two cases in which 2.5 % are allowed:
/// - The energy falls by 0.5 % or more. The old mesh is too stiff there, and the longer it stays,
///   the farther the sheet has to move.
/// - The sheet lies on a collider and turns by 20 degrees or more from triangle to triangle. The
///   potential may then also rise by another share of the stored energy: half of what the mean
///   square of the dihedral angles falls [rad2].
///
/// A proposal that is not lower than the sheet as it is may have its dents, in which a coarse mesh
/// holds a sheet that should bend in one direction. It is then relaxed a second time, from a
/// softened membrane, and that result is taken if it is lower than both.
///
/// A sheet with inertia relaxes for a hundredth of a second, from rest: within it the edges and the
/// bends between triangles of a coarse mesh relax, while the sheet itself, which bends more slowly
/// and falls by half a millimetre, hardly moves. Its velocities stay.
///
/// With an accepted proposal comes a solver that has taken over the state of the old one. Nothing
/// yields. A rejected proposal leaves no trace.
///
/// input          constraints on vertices of the new mesh, at the positions of the old one; the
///                colliders stand still
/// dt             [s] of a frame
/// is_admissible  called last with (old sheet, new sheet, largest displacement [m]); returns
///                whether the swap may be made. Empty: always.
MeshSwapResult try_swap_mesh(Sheet&, Elastic&, MeshProposal, const StepInput& input, double dt,
                             const AdmissibilityCheck& is_admissible = {});

}  // namespace paperbake
