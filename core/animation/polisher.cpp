#include "core/animation/polisher.h"

#include "core/animation/initial_sheet.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/geometry/point_location.h"
#include "core/render/curved_surface.h"

#include <algorithm>
#include <optional>

namespace paperbake {
namespace {

/// A mesh that has the features of the whole shot and stays as it is.
class FixedMesh : public Method {
 public:
  FixedMesh(int max_triangles, const RenderFeatures& features)
      : max_triangles_(max_triangles), features_(features) {}

  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    RenderFeatures all{points, features_.creases};
    all.points.insert(all.points.end(), features_.points.begin(), features_.points.end());
    RenderMesh mesh = mesh_for_render(pattern, 0, all, max_triangles_);
    mesh.point_vertex.resize(points.size());
    return {std::move(mesh.pattern), std::move(mesh.triangles), std::move(mesh.point_vertex)};
  }

 private:
  int max_triangles_;
  const RenderFeatures& features_;
};

InitialSheet mesh_with(const Shot& shot, int max_triangles, const RenderFeatures& features) {
  FixedMesh mesh(max_triangles, features);
  return make_initial_sheet(shot, mesh, 0);
}

/// Where a sheet has the vertices of a fine mesh; curved: on the curved surface that the mesh of
/// the sheet stands for. |V|x3 [m]
Points3 set_shape(const Points2& pattern, const Sheet& rough, bool curved) {
  if (!curved) return MeshTransfer(rough.pattern, rough.triangles, pattern)(rough.x);
  Points3 x(pattern.rows(), 3);
  const PointLocator locator(rough.pattern, rough.triangles);
  const CurvedSurface surface = curve(rough);
  for (int v = 0; v < x.rows(); ++v) x.row(v) = surface.at(locator.locate(pattern.row(v)));
  return x;
}

ElasticOptions at_rest(ElasticOptions options) {
  options.inertia = Inertia::quasi_static;
  return options;
}

bool same_apices(const std::vector<SingularPoint>& a, const std::vector<SingularPoint>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(),
      [](const SingularPoint& p, const SingularPoint& q) { return p.pattern == q.pattern; });
}

}  // namespace

Polisher::Polisher(const Shot& shot, const ElasticOptions& options, int triangles,
                   const RenderFeatures& features)
    : started_(mesh_with(shot, triangles, features)), elastic_(shot.paper, at_rest(options)) {
  elastic_.set_mesh(started_.sheet, started_.stiffening);
}

PositionConstraints Polisher::constraints_of(const std::vector<HeldHandle>& held) const {
  PositionConstraints constraints;
  for (const HeldHandle& h : held) {
    const int vertex = started_.handle_vertex[h.handle];
    if (std::none_of(constraints.begin(), constraints.end(),
                     [&](const PositionConstraint& c) { return c.vertex == vertex; }))
      constraints.push_back({vertex, h.at});
  }
  return constraints;
}

Polished Polisher::operator()(const Sheet& rough, const std::vector<HeldHandle>& held,
                              const PlasticGrid* plastic_grid) {
  constexpr double dt = 1;  // [s] so long that the inertia term holds nothing back
  Polished result;
  Sheet& sheet = result.sheet;
  if (!same_apices(started_.sheet.singular, rough.singular)) {
    started_.sheet.singular = rough.singular;
    elastic_.set_mesh(started_.sheet, started_.stiffening);
  }
  sheet = started_.sheet;
  sheet.x = set_shape(sheet.pattern, rough, rough.triangles.rows() < sheet.triangles.rows());
  const PositionConstraints now = constraints_of(held);
  for (const PositionConstraint& c : now) sheet.x.row(c.vertex) = c.target;
  const Points3 given = sheet.x;

  std::optional<PlasticGrid> grid;
  if (plastic_grid) grid = *plastic_grid;
  elastic_.set_plastic_grid(grid ? &*grid : nullptr);
  result.energy_before = elastic_.evaluate_energies(sheet).energy;
  const ElasticReport report = elastic_.relax(sheet, {now}, dt, Relaxation::full);
  result.converged = report.converged;
  result.near_itself = report.contact;
  result.energy = report.energy;
  result.membrane_energy = report.membrane;
  result.iterations = report.iterations;
  elastic_.set_plastic_grid(nullptr);
  result.moved = rms_distance(sheet.x, given);
  return result;
}

}  // namespace paperbake
