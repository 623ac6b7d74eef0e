#include "core/polish.h"

#include "core/curved_surface.h"
#include "core/locate.h"
#include "core/pattern_mesh.h"
#include "core/transfer.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace paperbake {
namespace {

Method fixed_mesh(int triangles, const std::vector<Vector2d>& more) {
  Method method;
  method.name = "polish";
  method.first_mesh = [triangles, more](const Pattern& pattern, const std::vector<Vector2d>& points) {
    std::vector<Vector2d> all = points;
    all.insert(all.end(), more.begin(), more.end());
    PatternMesh mesh = mesh_pattern_with(pattern, triangles, all);
    mesh.point_vertex.resize(points.size());
    return Method::FirstMesh{std::move(mesh.vertices), std::move(mesh.triangles), std::move(mesh.point_vertex)};
  };
  return method;
}

}  // namespace

Polisher::Polisher(const Shot& shot, const ElasticOptions& options, int triangles, const std::vector<Vector2d>& points)
    : paper_(shot.paper), options_(options), started_(start_sheet(shot, fixed_mesh(triangles, points), 0)) {
  options_.inertia = Inertia::quasi_static;
}

Held Polisher::grip(const std::vector<int>& held, const Points3& held_at) const {
  Held grip;
  for (std::size_t k = 0; k < held.size(); ++k) {
    const int vertex = started_.handle_vertex[held[k]];
    if (std::find(grip.vertices.begin(), grip.vertices.end(), vertex) != grip.vertices.end()) continue;
    grip.vertices.push_back(vertex);
    grip.targets.conservativeResize(grip.vertices.size(), 3);
    grip.targets.bottomRows(1) = held_at.row(k);
  }
  return grip;
}

Polished Polisher::operator()(const Sheet& rough, const std::vector<int>& held, const Points3& held_at, const PlasticGrid* memory) const {
  constexpr int most_settlings = 6;  // the trace of inertia holds each back
  constexpr double dt = 1.0 / 24;
  Polished result;
  Sheet& sheet = result.sheet;
  sheet = started_.sheet;
  if (rough.triangles.rows() < sheet.triangles.rows()) {
    const Locator locator(rough.pattern, rough.triangles);
    const CurvedSurface surface = curve(rough);
    for (int v = 0; v < sheet.x.rows(); ++v) sheet.x.row(v) = surface.at(locator.locate(sheet.pattern.row(v)));
  } else {
    sheet.x = Transfer(rough.pattern, rough.triangles, sheet.pattern)(rough.x);
  }
  const Held now = grip(held, held_at);
  for (std::size_t k = 0; k < now.vertices.size(); ++k) sheet.x.row(now.vertices[k]) = now.targets.row(k);
  const Points3 given = sheet.x;

  Elastic elastic(paper_, options_);
  std::optional<PlasticGrid> grid;
  if (memory) elastic.remember_in(&grid.emplace(*memory));
  elastic.set_mesh(sheet, started_.stiffening);
  result.energy_before = elastic.look(sheet).energy;
  for (int time = 0; time < most_settlings; ++time) {
    const Points3 before = sheet.x;
    const ElasticReport report = elastic.settle(sheet, now, dt, Settling::fully);
    result.converged = report.converged;
    result.near_itself |= report.contact;
    result.energy = report.energy;
    if (!report.converged || (sheet.x - before).rowwise().norm().maxCoeff() < 3 * options_.stop) break;
  }
  result.moved = std::sqrt((sheet.x - given).rowwise().squaredNorm().mean());
  return result;
}

}  // namespace paperbake
