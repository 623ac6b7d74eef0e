#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

struct DevelopableOptions {
  // [1] |l - L|/L that no one sees: less is not corrected, more only down to it, so nothing jumps
  // in time
  double left_alone = 5e-4;
  int max_iterations = 4;  // [1] one factorisation each
  // [1] of the pattern's size: what would move a vertex farther is no small correction
  double max_move = 0.005;
};

struct Restored {
  int iterations = 0;
  double before = 0, after = 0;  // [1] worst |l - L|/L of the edges
  double moved = 0;              // [m] farthest way of a vertex
};

/// Step 3 of [Schreck 2015]: the sheet that is handed on has the lengths of its pattern, so it is
/// developable but for its singular points: triangles with their true edges have their true angles,
/// and those add up to 2 pi round a vertex.
///
/// Levenberg-Marquardt on the edges, with the vertices weighted by the area they stand for, so that
/// the sheet as a whole stays where step 1 found its equilibrium:
///
///   min  sum_e  A_e (s_e + n_e . (d_i - d_j)/L_e)^2  +  eps sum_v A_v/a |d_v|^2
///
/// s_e what |l - L|/L of an edge is more than `left_alone`, with its sign; n_e its direction; a =
/// mean A_v.
///
/// A sheet has 3 V - 6 ways to move and fewer edges than that unless handles hold its border, so
/// what is left over is where handles ask for more than paper gives: there the least square
/// remains. eps grows where an iteration would make the sum larger or send a vertex too far.
/// held    vertices that keep their place
/// source  this project; the text of [Schreck 2015] names the step, not its weights
Restored restore_lengths(Sheet&, const std::vector<int>& held, const DevelopableOptions& = {});

}  // namespace paperbake
