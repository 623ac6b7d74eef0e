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
// Frames one after the other in which the sheet must stretch, or be folded on a finer mesh: a flat
// sheet that leaves the ground stretches a little in its first frame, when it has hardly any energy
// yet.
constexpr int frames_for_certain = 2;

// [1] edges as shares of the elasto-gravity length; assumed, and tried on arches of 0.15 to 1 m
// that hands push up within 0.5 to 4 s. On edges of the first length, bends of paper on the ground
// are smooth when it is moved slowly, on those of the second one also when it begins in waves
// because it is moved at once.
constexpr double fine = 0.25, finest = 0.125;

/// Edges of a mesh of so many triangles as a share of the elasto-gravity length (D/(rho g))^(1/3):
/// the weight of a sheet that lies on the ground leaves no smaller bends. Without gravity there is
/// no such length, and the share is 0. [1]
/// gravity  [m/s2]
/// source   that length: [Vella 2009]
double edge_on_ground(const Shot& shot, int triangles, double gravity) {
  const Paper& paper = shot.paper;
  if (gravity <= 0) return 0;
  return equilateral_edge(shot.pattern, triangles) /
         std::cbrt(paper.bending_stiffness / (paper.area_density * gravity));
}

/// How the opening of a shot goes on a mesh.
/// bends       as paper does
/// stretches   instead of bending
/// is_folded   the sheet lies on triangles that turn so far from one to the next that they hold it
///             back
/// crumples    it has got singular points
/// fails       the simulation ended with an error
enum class Opening { bends, stretches, is_folded, crumples, fails };

/// Simulates the opening of a shot.
/// patience  frames one after the other for which the sheet may be folded: until then a ruled mesh
///           may come that follows the bend. A sheet that is folded in the last frame is_folded.
Opening play_opening(SheetSimulation& sheet, const AnimateOptions& options, int patience) {
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
    if (locked == frames_for_certain) return Opening::stretches;
    if (folded == patience) break;
  }
  if (!sheet.sheet().singular.empty()) return Opening::crumples;
  return folded > 0 ? Opening::is_folded : Opening::bends;
}

/// Plays the opening on finer and finer first meshes, until the sheet bends.
class OpeningOnMeshes {
 public:
  OpeningOnMeshes(const Shot& shot, const MethodChoice& method, const AnimateOptions& options)
      : shot_(shot), method_(method), options_(options), found_{0, options.first_frame - 1, false} {
    options_.checks_mesh = false;  // nobody reads it
  }

  Rehearsal operator()() {
    found_.doublings = needed_doublings();
    return found_;
  }

 private:
  SheetSimulation sheet_on(int doublings) const {
    return SheetSimulation(shot_, method_, options_, {0, {doublings, found_.last_frame, false}});
  }

  Opening play(SheetSimulation& sheet, int patience) {
    Opening how = Opening::fails;
    try {
      how = play_opening(sheet, options_, patience);
    } catch (const Error& error) {
      // if it is the mesh of the shot, that says so in the frame where it happens
      if (error.code == ErrorCode::stopped) throw;
    }
    found_.last_frame = std::max(found_.last_frame, sheet.keys_until());
    return how;
  }

  /// Where the sheet bends on none of the meshes, the paper crumples, or there are not enough
  /// triangles for it: no doublings are needed then, or those without which it stretches.
  int needed_doublings() {
    int tried = 0, at_least = 0;
    {
      SheetSimulation sheet = sheet_on(0);
      if (!sheet.may_start_finer()) return 0;
      const Opening how = play(sheet, most_frames);
      if (how == Opening::bends || how == Opening::fails) return 0;
      if (how == Opening::stretches) at_least = doublings_to_bend;
    }
    for (int wanted = doublings_to_bend;; ++wanted) {
      SheetSimulation sheet = sheet_on(wanted);
      if (sheet.doublings() == tried) {
        found_.lacks_triangles = true;
        return std::min(at_least, tried);
      }
      tried = sheet.doublings();
      const double edge = edge_on_ground(shot_, static_cast<int>(sheet.sheet().triangles.rows()),
                                         options_.elastic.forces.gravity);
      if (edge <= fine && tried == at_least) return tried;
      if (play(sheet, frames_for_certain) == Opening::bends) return tried;
      if (edge <= finest) return at_least;
    }
  }

  const Shot& shot_;
  const MethodChoice& method_;
  AnimateOptions options_;
  Rehearsal found_;
};

}  // namespace

Rehearsal rehearse(const Shot& shot, const MethodChoice& method, const AnimateOptions& options) {
  if (!shot.colliders || shot.handles.empty() || !options.resume_state.empty())
    return {0, options.first_frame - 1, false};
  return OpeningOnMeshes(shot, method, options)();
}

}  // namespace paperbake
