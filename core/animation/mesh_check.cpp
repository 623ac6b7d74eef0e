#include "core/animation/mesh_check.h"

#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"

#include <utility>

namespace paperbake {

std::optional<double> distance_from_finer_mesh(const SimulatedSheet& simulated,
                                               const Method& method, const StepInput& at) {
  constexpr int refinement = 4;
  // [triangles] A mesh that leads to more is not the coarse first mesh that this is about.
  constexpr int most = 1500;
  constexpr double dt = 1;  // [s] so long that the inertia term holds nothing back
  std::optional<PatternMesh> mesh =
      method.mesh_with_creases(simulated.shot.pattern, required_points(simulated.shot), refinement);
  if (!mesh || mesh->triangles.rows() > most) return std::nullopt;
  const Sheet& sheet = simulated.sheet;
  Sheet finer = on_other_mesh(sheet, std::move(mesh->vertices), std::move(mesh->triangles));
  finer.v.setZero();
  Elastic elastic = simulated.elastic.on_mesh(finer, disc_factors(finer, simulated.shot));
  try {
    const ElasticReport report = elastic.relax(finer, at, dt, Relaxation::full);
    if (!report.converged || report.contact || report.on_colliders > 0) return std::nullopt;
  } catch (const EnergyNotFinite&) {
    return std::nullopt;
  }
  const Points3 there = MeshTransfer(finer.pattern, finer.triangles, sheet.pattern)(finer.x);
  return rms_distance(there, sheet.x) / simulated.side;
}

void MeshCheck::look(const SimulatedSheet& simulated, const Method& method, const StepInput& at,
                     double deformation, bool is_at_rest) {
  constexpr double deformation_of_check = 0.05;  // [1] of the longer side
  deformed_ += deformation;
  if (!is_at_rest || !simulated.is_smooth()) {
    error_ = 0;
    deformed_ = deformation_of_check;
    return;
  }
  if (deformed_ < deformation_of_check) return;
  deformed_ = 0;
  error_ = distance_from_finer_mesh(simulated, method, at).value_or(0);
}

}  // namespace paperbake
