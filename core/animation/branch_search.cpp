#include "core/animation/branch_search.h"

#include "core/animation/imperfection.h"
#include "core/animation/snapshot.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/random.h"
#include "core/model/formatted.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double amplitudes[] = {0.02, 0.06};  // [1] of the longer side
constexpr double same = 0.02;  // [1] of the energy: another branch is lower by more than this
// [1] of the longer side, RMS: a shape closer than this is the same
constexpr double another_shape = 0.01;
constexpr int max_steps_in_touch = 12;

/// The sheet displaced along its normals, by an RMS height of `height`. [m]
Sheet pushed(const Sheet& sheet, double side, double height, std::uint32_t seed) {
  Eigen::VectorXd wave(sheet.x.rows());
  for (int v = 0; v < wave.size(); ++v) wave[v] = imperfection(sheet.pattern.row(v), side, seed);
  const double size = std::sqrt(wave.squaredNorm() / wave.size());
  Sheet moved = sheet;
  if (size > 0)
    moved.x += (height / size) * wave.asDiagonal() * vertex_normals(sheet.x, sheet.triangles);
  return moved;
}

/// [J] By how much another branch is lower.
double least_step(const ElasticReport& here, const Elastic& elastic) {
  return same * std::max(here.energy, energy_when_nearly_flat(elastic.paper()));
}

/// The search for a sheet that touches itself.
BranchSearch finish(Sheet& sheet, Elastic& elastic, const StepInput& input, double dt) {
  const Snapshot before(sheet, elastic);
  const ElasticReport here = elastic.evaluate_energies(sheet);
  ElasticReport there = here;
  there.converged = false;
  for (int k = 0; k < max_steps_in_touch && !there.converged; ++k)
    there = elastic.step(sheet, input, dt);
  BranchSearch found;
  found.before = here.potential;
  found.after = there.potential;
  found.finished = there.potential < here.potential - least_step(here, elastic) &&
                   crossings(sheet) <= crossings(before.sheet);
  if (found.finished) return found;
  found.after = found.before;
  before.restore(sheet, elastic);
  return found;
}

/// Brings the sheet to the minimum in whose basin it lies.
ElasticReport relax_fully(Sheet& sheet, Elastic& elastic, const StepInput& input, double dt) {
  ElasticReport report;
  // the inertia term holds it where it was pushed to, a little less every time
  for (int time = 0; time < 3; ++time)
    if (report = elastic.relax(sheet, input, dt, Relaxation::full); !report.converged) break;
  return report;
}

}  // namespace

BranchSearch probe_branches(Sheet& sheet, Elastic& elastic, const StepInput& input,
                            const BranchSearchOptions& options) {
  const double dt = options.dt;
  const double side = longer_side(sheet.pattern);
  const Snapshot as_it_was(sheet, elastic);
  if (as_it_was.state.had_contact) return finish(sheet, elastic, input, dt);
  SolverState no_past = as_it_was.state;
  no_past.positions.clear();
  no_past.second.reset();
  elastic.restore(no_past);

  // The sheet itself is relaxed in the same way: what its minimisation has left over is not another
  // branch.
  Sheet lowest = sheet;
  ElasticReport here = relax_fully(lowest, elastic, input, dt);
  if (!here.converged || here.contact) {
    here = elastic.evaluate_energies(sheet);
    lowest = sheet;
  }
  const double step = least_step(here, elastic);
  BranchSearch found;
  found.before = found.after = here.potential;
  double least = here.potential - step;
  const Points3 now = lowest.x;
  int candidate = 0;
  for (const double amplitude : amplitudes)
    for (int k = 0; k < options.waves_of_each; ++k) {
      const auto wave = static_cast<std::uint32_t>(
          scramble((std::uint64_t(options.seed) << 32 | std::uint32_t(options.frame)) +
                   0x9e3779b97f4a7c15ull * ++candidate));
      Sheet other = pushed(sheet, side, amplitude * side, wave);
      const ElasticReport there = relax_fully(other, elastic, input, dt);
      if (!there.converged || crossings(other) > 0) continue;
      if (std::abs(there.potential - here.potential) <= step)
        found.equal |= rms_distance(other.x, now) > another_shape * side;
      if (there.potential < least) {
        least = there.potential;
        found.taken = true;
        lowest = std::move(other);
      }
    }
  elastic.restore(as_it_was.state);
  if (!found.taken) return found;

  elastic.restore(no_past);
  sheet.x = lowest.x;
  const ElasticReport has_arrived = elastic.step(sheet, input, dt);
  if (has_arrived.converged && crossings(sheet) == 0) {
    found.after = least;
    found.equal = false;
    return found;
  }
  as_it_was.restore(sheet, elastic);
  found.taken = false;
  return found;
}

std::string note_of(const BranchSearch& found) {
  const double share = 100 * (found.before - found.after) / std::abs(found.before);
  if (found.taken)
    return formatted(
        "bistable: a probe found a branch %.0f %% lower (%.3g J instead of %.3g J) and took it",
        share, found.after, found.before);
  if (found.finished)
    return formatted("unfinished: a probe got %.0f %% lower (%.3g J instead of %.3g J)", share,
                     found.after, found.before);
  if (found.equal)
    return formatted("bistable: another branch of equal energy (%.3g J)", found.before);
  return "";
}

}  // namespace paperbake
