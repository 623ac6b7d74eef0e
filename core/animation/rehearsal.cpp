#include "core/animation/rehearsal.h"

#include "core/animation/sheet_simulation.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/model/error.h"

#include <string>

namespace paperbake {
namespace {

constexpr double opening = 0.1;  // [1] of the longer side, that handles move in the rehearsal
constexpr int most_frames = 64;
// Frames one after the other that must be locked: a flat sheet that leaves the ground stretches a
// little in its first frame, when it has hardly any energy yet.
constexpr int locked_for_certain = 2;

bool is_held_back(SheetSimulation& sheet, const AnimateOptions& options) {
  const int end = options.first_frame + most_frames - 1;
  const AdmissibilityCheck is_admissible = [](const Sheet&, const Sheet&, double) { return true; };
  double travel = 0;
  int locked = 0;
  while (sheet.next_frame() <= end && travel < opening && sheet.may_start_finer()) {
    if (options.asks_to_stop && options.asks_to_stop())
      throw Error(ErrorCode::stopped, "before frame " + std::to_string(options.first_frame),
                  "The simulation was stopped.", "The same command starts it again.");
    sheet.prepare(is_admissible);
    sheet.step(SheetSimulation::RecordTrajectory::no, is_admissible);
    sheet.finish_step(is_admissible);
    sheet.finalize(SheetSimulation::Output::simulated_sheet);
    travel += sheet.relative_motion();
    locked = sheet.stretches_instead_of_bending() ? locked + 1 : 0;
    if (locked == locked_for_certain) return true;
  }
  return false;
}

}  // namespace

Rehearsal rehearse(const Shot& shot, const MethodChoice& method, const AnimateOptions& options) {
  Rehearsal found{0, options.first_frame - 1};
  if (!shot.colliders || shot.handles.empty() || !options.resume_state.empty()) return found;
  SheetSimulation sheet(shot, method, options, {0, found});
  try {
    if (is_held_back(sheet, options)) found.doublings = doublings_to_bend;
  } catch (const Error& error) {
    // the shot itself says so, in the frame where it happens
    if (error.code == ErrorCode::stopped) throw;
  }
  found.last_frame = sheet.next_frame() - 1;
  return found;
}

}  // namespace paperbake
