#include "core/animation/simulated_sheet.h"

#include "core/geometry/mesh_transfer.h"

#include <utility>

namespace paperbake {
namespace {

ElasticOptions options_of(const Shot& shot, const AnimateOptions& options, std::size_t number) {
  ElasticOptions elastic = options.elastic;
  elastic.colliders = shot.colliders;
  elastic.sheet_number = static_cast<int>(number);
  return elastic;
}

}  // namespace

SimulatedSheet::SimulatedSheet(const Shot& shot, InitialSheet&& start,
                               const AnimateOptions& options, std::size_t number)
    : shot(shot),
      side(longer_side(shot.pattern)),
      sheet(std::move(start.sheet)),
      handle_vertex(std::move(start.handle_vertex)),
      fixed(std::move(start.fixed)),
      has_bends(start.has_bends),
      elastic(shot.paper, options_of(shot, options, number)) {
  if (options.plasticity == Plasticity::on)
    elastic.set_plastic_grid(&plastic_grid.emplace(shot.pattern));
  elastic.set_mesh(sheet, start.stiffening);
}

void SimulatedSheet::restore(const MeshSnapshot& back) {
  sheet = back.sheet;
  update_solver();
  elastic.restore(back.state);
  fixed = back.fixed;
  has_bends = back.has_bends;
  positions_before = back.positions_before;
}

void SimulatedSheet::update_solver() { elastic.set_mesh(sheet, disc_factors(sheet, shot)); }

void SimulatedSheet::carry_over(const Sheet& before) {
  SolverState known = elastic.state();
  const MeshTransfer onto(before.pattern, before.triangles, sheet.pattern);
  for (Points3& x : known.positions) x = onto(x);
  if (positions_before.rows() == before.x.rows()) positions_before = onto(positions_before);
  if (known.second) known.second->x = onto(known.second->x);
  known.remeshed = true;
  known.ridges = {};
  known.friction.clear();
  update_solver();
  elastic.restore(known);
}

void SimulatedSheet::put_on(PatternMesh&& mesh) {
  const MeshSnapshot before = snapshot();
  try {
    fixed = are_required(mesh);
    sheet = on_other_mesh(before.sheet, std::move(mesh.vertices), std::move(mesh.triangles));
    carry_over(before.sheet);
  } catch (...) {
    restore(before);
    throw;
  }
}

Points3 SimulatedSheet::initial_positions() const {
  return MeshTransfer(shot.start.pattern, shot.start.triangles, sheet.pattern)(shot.start.x);
}

bool SimulatedSheet::is_smooth() const {
  return !has_bends && sheet.singular.empty() && sheet.prescribed_creases.empty();
}

}  // namespace paperbake
