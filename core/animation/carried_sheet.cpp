#include "core/animation/carried_sheet.h"

#include "core/geometry/measure.h"

#include <utility>

namespace paperbake {

void CarriedSheet::begin(const Sheet& sheet, const StepInput& at) {
  sheet_ = sheet;
  is_carried_ = false;
  at_ = at;
}

void CarriedSheet::carry(SimulatedSheet& simulated, const Method& method, const Points3& start,
                         double dt) {
  // [1] of the longer side: what goes farther is on another branch
  constexpr double same_branch = 0.03;
  if (!sheet_) return;
  Sheet carried = simulated.sheet;
  carried.x = start;
  sheet_.reset();
  // its folds lie elsewhere on another mesh: halfway between both is no shape of paper
  if (method.is_crumpled(carried)) return;
  if (!simulated.has_inertia()) {
    const SolverState known = simulated.elastic.state();
    const ElasticReport settled = simulated.elastic.relax(carried, at_, dt, Relaxation::full);
    simulated.elastic.restore(known);
    if (!settled.converged || settled.contact ||
        max_row_norm(carried.x - start) > same_branch * simulated.side)
      return;
  }
  sheet_ = std::move(carried);
  is_carried_ = true;
}

Points3 CarriedSheet::positions(const Sheet& now, const Method& method) const {
  // within the step, the mesh may have changed once more
  if (!is_carried_ || !sheet_ || !same_entries(sheet_->triangles, now.triangles) ||
      !same_entries(sheet_->pattern, now.pattern))
    return {};
  Sheet finished = *sheet_;
  method.finish(finished, vertices_of(at_.constraints));
  return finished.x;
}

}  // namespace paperbake
