#include "core/animation/initial_sheet.h"

#include "core/animation/imperfection.h"
#include "core/animation/start_mesh.h"
#include "core/geometry/mesh_transfer.h"
#include "core/geometry/prescribed_creases.h"
#include "core/hands/closing_hands.h"

namespace paperbake {

std::vector<double> disc_factors(const Sheet& sheet, const Shot& shot) {
  // [1] times the bending stiffness of the paper, where fingers keep it flat; assumed
  constexpr double disc_stiffening = 10;
  constexpr double rounding = 1.001;  // [1] of the radius
  std::vector<double> factors(sheet.triangles.rows(), 1.0);
  for (std::size_t h = 0; h < shot.handles.size(); ++h) {
    const double radius = disc_radius(shot.handles, h, shot.pattern);
    if (radius <= 0) continue;
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      bool within = true;
      for (int i = 0; i < 3; ++i)
        within &= (sheet.pattern.row(sheet.triangles(t, i)).transpose() - shot.handles[h].pattern)
                      .norm() <= rounding * radius;
      if (within) factors[t] = disc_stiffening;
    }
  }
  return factors;
}

std::vector<Vector2d> required_points(const Shot& shot) {
  std::vector<Vector2d> points;
  for (const Handle& handle : shot.handles) points.push_back(handle.pattern);
  for (std::size_t h = 0; h < shot.handles.size(); ++h)
    for (const Vector2d& p : disc_rim(shot.pattern, shot.handles[h].pattern,
                                      disc_radius(shot.handles, h, shot.pattern)))
      points.push_back(p);
  const std::vector<Vector2d> between = points_in_closing_hands(shot);
  points.insert(points.end(), between.begin(), between.end());
  points.insert(points.end(), shot.singular_point_rules.fixed.begin(),
                shot.singular_point_rules.fixed.end());
  return points;
}

InitialSheet make_initial_sheet(const Shot& shot, Method& method, unsigned seed, int first_frame) {
  const std::vector<Vector2d> points = required_points(shot);
  auto [mesh, has_bends] = mesh_of_start(shot, method, points);
  InitialSheet started;
  started.has_bends = has_bends;
  started.handle_vertex.assign(mesh.point_vertex.begin(),
                               mesh.point_vertex.begin() + shot.handles.size());
  Sheet& sheet = started.sheet;
  sheet.pattern = std::move(mesh.vertices);
  sheet.triangles = std::move(mesh.triangles);
  sheet.v = Points3::Zero(sheet.pattern.rows(), 3);
  sheet.prescribed_creases = shot.pattern.prescribed_creases;
  for (std::size_t k = 0; k < shot.singular_point_rules.fixed.size(); ++k)
    sheet.singular.push_back(
        {sheet.pattern
             .row(mesh.point_vertex[points.size() - shot.singular_point_rules.fixed.size() + k])
             .transpose(),
         first_frame, "kept here"});
  sheet.x = MeshTransfer(shot.start.pattern, shot.start.triangles, sheet.pattern)(shot.start.x);
  add_geometric_imperfection(sheet, longer_side(shot.pattern), seed);

  started.fixed.assign(sheet.pattern.rows(), 0);
  for (std::size_t k = 0; k < mesh.point_vertex.size(); ++k) {
    const int v = mesh.point_vertex[k];
    const Vector2d p = sheet.pattern.row(v);
    if (k < points.size() || crease_under(sheet.prescribed_creases, p, p)) started.fixed[v] = 1;
  }
  started.stiffening = disc_factors(sheet, shot);
  return started;
}

}  // namespace paperbake
