#include "core/methods/method.h"

#include "core/geometry/pattern_mesh.h"
#include "core/methods/adaptive_mesh/edge_operations.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace paperbake {
namespace {

enum class Pass { both_ways, coarsen };

/// A mesh is changed when there is something to gain: every change costs the sheet some iterations
/// to come to rest again.
bool is_due(const Sheet& sheet, const Points3& metric) {
  constexpr double far_too_long = 1.25;  // [1] of an edge as long as it should be
  constexpr double many = 0.01;          // [1] of the edges
  constexpr double too_many = 1.3;       // [1] of the triangles that the field asks for
  const Misfit is = misfit(sheet, metric);
  return is.longest > far_too_long || is.too_long > many ||
         sheet.triangles.rows() > too_many * triangles_of(sheet, metric);
}

/// One pass over a sheet at rest on its mesh: it may become twice as fine, but no finer at once.
/// returns  did the mesh change?
bool adapt(Sheet& sheet, Points3 metric, int fixed, int max_triangles, Pass pass) {
  // [1] of the length at which edges are split: what was split is not joined again
  constexpr double joined_below = 0.8;
  constexpr int rounds_of_splits = 2;
  const int rounds_of_collapses = pass == Pass::both_ways ? 3 : 10;
  // a field that asks for too much is coarsened as a whole
  metric *= std::min(1.0, max_triangles / triangles_of(sheet, metric));
  if (!is_due(sheet, metric)) return false;
  bool changed = false;
  for (int round = 0; pass == Pass::both_ways && round < rounds_of_splits; ++round) {
    const int splits = split_long_edges(sheet, metric, max_triangles);
    changed |= flip_to_delaunay(sheet, metric) > 0 || splits > 0;
    if (splits == 0) break;
  }
  for (int round = 0; round < rounds_of_collapses; ++round) {
    if (collapse_short_edges(sheet, metric, fixed, joined_below) == 0) break;
    flip_to_delaunay(sheet, metric);
    changed = true;
  }
  return changed;
}

}  // namespace

Method adaptive(const Pattern& pattern, int max_triangles, const SizingOptions& options,
                double turn) {
  Method method;
  method.name = "adaptive";
  method.first_mesh = [=](const Pattern& cut, const std::vector<Vector2d>& points) {
    constexpr double mean_edge = 0.8;  // [1] of the longest that is not split
    PatternMesh mesh =
        mesh_pattern(cut, mean_edge * options.largest * std::sqrt(area(cut)), points, turn);
    number_points_first(mesh);
    return Method::FirstMesh{std::move(mesh.vertices), std::move(mesh.triangles),
                             std::move(mesh.point_vertex)};
  };
  const auto unfinished = std::make_shared<bool>(true);  // the last pass changed the mesh
  const double side = longer_side(pattern);
  method.remesh = [=](Sheet& sheet, const RemeshContext& is) {
    // a jump is followed in many steps, and what the sheet looks like afterwards has little to do
    // with what it is fine for now
    constexpr double far = 0.1;  // [1] of the longer side
    constexpr int enough_for_a_jump = 400;
    const bool jumps = is.relative_handle_motion > far;
    // nor is a shape on its way down a reason for triangles
    if (!jumps && (!is.at_minimum || !(is.moving || *unfinished))) return false;
    const Points3 kept =
        is.memory ? is.memory->at_vertices(sheet.pattern, sheet.triangles) : Points3(0, 3);
    const int required = static_cast<int>(std::count(is.fixed.begin(), is.fixed.end(), 1));
    const Points3 metric = sizing_field(sheet, kept, side, options);
    const bool changed = jumps ? adapt(sheet, metric, required,
                                       std::min(max_triangles, enough_for_a_jump), Pass::coarsen)
                               : adapt(sheet, metric, required, max_triangles, Pass::both_ways);
    *unfinished = changed || (jumps && *unfinished);
    return changed;
  };
  method.archive = [unfinished](Serializer& a) { a(*unfinished); };
  return method;
}

}  // namespace paperbake
