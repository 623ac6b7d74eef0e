#include "core/animation/rehearsal.h"

#include "core/animation/sheet_simulation.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/geometry/pattern_mesh.h"
#include "core/model/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace paperbake {
namespace {

// [1] of the longer side, that handles move in the rehearsal
constexpr double most_travel = 0.1;
constexpr int most_frames = 64;
// Frames one after the other that must be locked, or folded on a finer mesh: a flat sheet that
// leaves the ground stretches a little in its first frame, when it has hardly any energy yet.
constexpr int locked_for_certain = 2;

// [1] of the elasto-gravity length: on edges of this length, bends of paper on the ground are
// smooth; assumed, and tried on arches of 0.15 to 1 m that hands push up
constexpr double fine_enough = 0.25;

/// Whether bends of a sheet that lies on the ground are smooth on so many triangles. Its weight
/// leaves them no smaller than the elasto-gravity length (D/(rho g))^(1/3).
/// gravity  [m/s2]
/// source   that length: [Vella 2009]
bool is_fine_on_ground(const Shot& shot, int triangles, double gravity) {
  const Paper& paper = shot.paper;
  if (gravity <= 0) return true;
  const double length = std::cbrt(paper.bending_stiffness / (paper.area_density * gravity));
  return equilateral_edge(shot.pattern, triangles) <= fine_enough * length;
}

/// How a sheet fares on its first mesh.
/// bends       as paper does
/// stretches   instead of bending
/// is_folded   it lies on triangles that turn so far from one to the next that they hold it back
enum class Opening { bends, stretches, is_folded };

/// Simulates the opening of a shot.
/// patience  frames one after the other for which the sheet may be folded: until then a ruled mesh
///           may come that follows the bend
Opening open(SheetSimulation& sheet, const AnimateOptions& options, int patience) {
  const int end = options.first_frame + most_frames - 1;
  const AdmissibilityCheck is_admissible = [](const Sheet&, const Sheet&, double) { return true; };
  double travel = 0;
  int locked = 0, folded = 0;
  while (sheet.next_frame() <= end && travel < most_travel && sheet.is_rehearsed()) {
    if (options.asks_to_stop && options.asks_to_stop())
      throw Error(ErrorCode::stopped, "before frame " + std::to_string(options.first_frame),
                  "The simulation was stopped.", "The same command starts it again.");
    sheet.prepare(is_admissible);
    sheet.step(SheetSimulation::RecordTrajectory::no, is_admissible);
    sheet.finish_step(is_admissible);
    sheet.finalize(SheetSimulation::Output::simulated_sheet);
    travel += sheet.relative_motion();
    locked = sheet.stretches_instead_of_bending() ? locked + 1 : 0;
    folded = sheet.rests_on_coarse_folds() ? folded + 1 : 0;
    if (locked == locked_for_certain) return Opening::stretches;
    if (folded == patience) break;
  }
  return folded > 0 ? Opening::is_folded : Opening::bends;
}

/// Doublings of the number of triangles with which the sheet bends in the opening. Where none does,
/// the paper crumples: none are needed then, or those without which it stretches.
int needed_doublings(const Shot& shot, const MethodChoice& method, const AnimateOptions& options,
                     int& last_frame) {
  const auto sheet_on = [&](int doublings) {
    return SheetSimulation(shot, method, options, {0, {doublings, last_frame}});
  };
  const auto rehearse_on = [&](SheetSimulation& sheet, int patience) {
    const Opening found = open(sheet, options, patience);
    last_frame = std::max(last_frame, sheet.next_frame() - 1);
    return found;
  };
  SheetSimulation first = sheet_on(0);
  if (!first.may_start_finer()) return 0;
  const Opening found = rehearse_on(first, most_frames);
  if (found == Opening::bends) return 0;
  const int at_least = found == Opening::stretches ? doublings_to_bend : 0;
  for (int doublings = doublings_to_bend;; ++doublings) {
    SheetSimulation sheet = sheet_on(doublings);
    if (sheet.doublings() < doublings) return at_least;
    const bool is_fine = is_fine_on_ground(shot, static_cast<int>(sheet.sheet().triangles.rows()),
                                           options.elastic.forces.gravity);
    if (is_fine && doublings == at_least) return at_least;
    if (rehearse_on(sheet, locked_for_certain) == Opening::bends) return doublings;
    if (is_fine) return at_least;
  }
}

}  // namespace

Rehearsal rehearse(const Shot& shot, const MethodChoice& method, const AnimateOptions& options) {
  Rehearsal found{0, options.first_frame - 1};
  if (!shot.colliders || shot.handles.empty() || !options.resume_state.empty()) return found;
  try {
    found.doublings = needed_doublings(shot, method, options, found.last_frame);
  } catch (const Error& error) {
    // the shot itself says so, in the frame where it happens
    if (error.code == ErrorCode::stopped) throw;
  }
  return found;
}

}  // namespace paperbake
