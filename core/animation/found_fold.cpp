#include "core/animation/found_fold.h"

#include "core/animation/initial_sheet.h"
#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/error.h"

#include <algorithm>
#include <utility>

namespace paperbake {
namespace {

constexpr double kept_energy = 0.9;    // [1] of what is stored, at most
constexpr double max_stretch = 0.005;  // [1] |l - L|/L of an edge
constexpr double max_move = 0.1;       // [1] of the longer side, in contact
constexpr double deepest = 2e-5;       // [m] in a collider

/// The sheet on a mesh with one crease more, where it is folded along that crease.
std::optional<FoundFold> with_crease(const FoldLine& line, const UnfoldedSheet& is,
                                     const Method& method) {
  Pattern pattern = is.shot.pattern;
  pattern.prescribed_creases = is.sheet.prescribed_creases;
  pattern.prescribed_creases.push_back({{line.a, line.b}, 0, false});
  std::vector<Vector2d> points = required_points(is.shot);
  for (const SingularPoint& point : is.sheet.singular) points.push_back(point.pattern);
  std::optional<Method::FirstMesh> mesh = method.mesh_with_creases(pattern, points);
  if (!mesh) return std::nullopt;

  Sheet sheet;
  const MeshTransfer onto(is.sheet.pattern, is.sheet.triangles, mesh->pattern);
  sheet.x = onto(is.sheet.x);
  sheet.v = onto(is.sheet.v);
  sheet.pattern = std::move(mesh->pattern);
  sheet.triangles = std::move(mesh->triangles);
  sheet.singular = is.sheet.singular;
  sheet.prescribed_creases = std::move(pattern.prescribed_creases);
  sheet.crease_edges = is.sheet.crease_edges;
  const PrescribedCrease& crease = sheet.prescribed_creases.back();
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d a = sheet.pattern.row(hinge.vertices[0]),
                   b = sheet.pattern.row(hinge.vertices[1]);
    if (crease_under({crease}, a, b))
      sheet.crease_edges.push_back({a, b, line.plastic_turn, true, {}});
  }
  std::vector<char> fixed(sheet.pattern.rows(), 0);
  for (const int v : mesh->point_vertex) fixed[v] = 1;
  Elastic elastic = is.elastic.on_mesh(sheet, disc_factors(sheet, is.shot));
  return FoundFold{std::move(sheet), std::move(elastic), std::move(fixed), 0, 0, is.grid};
}

/// What the fold is compared with.
struct Before {
  explicit Before(const UnfoldedSheet& is)
      : stored(is.elastic.evaluate_energies(is.sheet).energy),
        inside(is.elastic.inside(is.sheet, is.input.colliders.to)),
        crossed(crossings(is.sheet)) {}
  double stored;  // [J]
  double inside;  // [m] depth in a collider
  int crossed;    // [1] pairs of triangles
};

/// Takes the step of the folded sheet, and says whether the fold is possible.
bool settles(FoundFold& fold, const UnfoldedSheet& is, const Before& before) {
  const Sheet carried = fold.sheet;
  ElasticReport after;
  try {
    after = fold.elastic.step(fold.sheet, is.input, is.dt);
  } catch (const Error&) {  // the energy is not finite
    return false;
  }
  fold.sheet.v = carried.v;
  fold.moved = max_row_norm(fold.sheet.x - carried.x);
  fold.stored = fold.elastic.evaluate_energies(fold.sheet).energy;
  if (!(fold.stored <= kept_energy * before.stored) ||
      !(length_distortion(fold.sheet).largest <= max_stretch))
    return false;
  if (after.contact && (fold.moved > max_move * longer_side(is.shot.pattern) ||
                        crossings(fold.sheet) > before.crossed))
    return false;
  return fold.elastic.inside(fold.sheet, is.input.colliders.to) <= std::max(deepest, before.inside);
}

/// Takes the plastic curvature of triangles out of the grid.
void remove_curl(PlasticGrid& grid, const Sheet& sheet, const std::vector<int>& triangles) {
  const PlasticGrid::Cover cover = grid.cover(sheet.pattern, sheet.triangles);
  const PlasticMemory memory = grid.read(cover);
  PlasticMemory removed(static_cast<int>(sheet.triangles.rows()));
  for (const int t : triangles) removed.curvature.row(t) = -memory.curvature.row(t);
  grid.write(cover, removed);
}

}  // namespace

std::optional<FoundFold> fold_along(const std::vector<FoldLine>& lines, const UnfoldedSheet& is,
                                    const Method& method) {
  const Before before(is);
  const SolverState known = is.elastic.state();
  std::optional<FoundFold> best;
  for (const FoldLine& line : lines) {
    remove_curl(is.grid, is.sheet, line.band);
    std::optional<FoundFold> fold = with_crease(line, is, method);
    const Points3 carried = fold ? fold->sheet.x : Points3();
    if (fold && settles(*fold, is, before) && (!best || fold->stored < best->stored)) {
      const MeshTransfer onto(is.sheet.pattern, is.sheet.triangles, fold->sheet.pattern);
      fold->elastic.continue_from(is.elastic, [&](const Points3& x) -> Points3 {
        return onto(x) + fold->sheet.x - carried;
      });
      fold->grid = is.grid;
      best = std::move(fold);
    }
    is.elastic.restore(known);
  }
  if (!best) return std::nullopt;
  is.grid = best->grid;
  best->elastic.set_plastic_grid(&is.grid);
  return best;
}

}  // namespace paperbake
