#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Options of restore_lengths.
struct DevelopableOptions {
  // [1] |l - L|/L that no one sees: smaller errors are left alone, and larger ones are reduced only
  // to this value, so that nothing jumps in time
  double left_alone = 5e-4;
  int max_iterations = 4;  // [1] one factorisation each
  // [1] largest displacement of a vertex as a fraction of the pattern's diagonal: beyond it the
  // correction is no longer small
  double max_move = 0.005;
};

/// What restore_lengths did.
struct Restored {
  int iterations = 0;
  double before = 0, after = 0;  // [1] largest |l - L|/L of an edge
  double moved = 0;              // [m] largest displacement of a vertex
};

/// Step 3 of [Schreck 2015]: restores the edge lengths of the pattern, so that the sheet that is
/// passed on is developable except at its singular points. Triangles with their true edge lengths
/// have their true angles, and those add up to 2 pi around a vertex.
///
/// Levenberg-Marquardt on the edge lengths, with each vertex weighted by the area it represents, so
/// that the sheet as a whole stays where step 1 found its equilibrium:
///
///   min  sum_e  A_e (s_e + n_e . (d_i - d_j)/L_e)^2  +  eps sum_v A_v/a |d_v|^2
///
/// where d_v is the displacement of a vertex, s_e the part of (l - L)/L of an edge that exceeds
/// `left_alone`, with its sign, n_e the direction of the edge, and a = mean A_v.
///
/// A sheet has 3 V - 6 degrees of freedom and fewer edges than that, unless handles hold its
/// border. So errors remain only where handles demand more than paper allows; there the sum of
/// their squares is smallest. eps grows when an iteration would increase the sum or move a vertex
/// too far.
/// held    vertices that keep their position
/// source  this project; the text of [Schreck 2015] names the step, not its weights
Restored restore_lengths(Sheet&, const std::vector<int>& held, const DevelopableOptions& = {});

}  // namespace paperbake
