#include "core/methods/method.h"

#include "core/adaptive_mesh/operations.h"
#include "core/pattern_mesh.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace paperbake {
namespace {

/// One pass over a sheet at rest on its mesh: it may become twice as fine, but no finer at once.
/// returns  did the mesh change?
bool adapt(Sheet& sheet, Points3 metric, int fixed, int most_triangles) {
  constexpr double joined_below = 0.8;  // [1] of the length at which edges are split: what was split is not joined again
  constexpr int rounds_of_splits = 2, rounds_of_collapses = 3;
  // a field that asks for too much is coarsened as a whole
  metric *= std::min(1.0, most_triangles / triangles_of(sheet, metric));
  bool changed = false;
  for (int round = 0; round < rounds_of_splits; ++round) {
    const int splits = split_long_edges(sheet, metric, most_triangles);
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

Method adaptive(const Pattern& pattern, int most_triangles, const SizingOptions& options, double turn) {
  Method method;
  method.name = "adaptive";
  method.first_mesh = [=](const Pattern& cut, const std::vector<Vector2d>& points) {
    constexpr double mean_edge = 0.8;  // [1] of the longest that is not split
    PatternMesh mesh = mesh_pattern(cut, mean_edge * options.largest * std::sqrt(area(cut)), points, turn);
    number_points_first(mesh);
    return Method::FirstMesh{std::move(mesh.vertices), std::move(mesh.triangles), std::move(mesh.point_vertex)};
  };
  const auto unfinished = std::make_shared<bool>(true);  // the last pass changed the mesh
  const double side = longer_side(pattern);
  method.remesh = [=](Sheet& sheet, const std::vector<char>& fixed, const PlasticGrid* memory, const Moment&, bool moving) {
    if (!moving && !*unfinished) return false;
    const Points3 kept = memory ? memory->at_vertices(sheet.pattern, sheet.triangles) : Points3(0, 3);
    const int required = static_cast<int>(std::count(fixed.begin(), fixed.end(), 1));
    return *unfinished = adapt(sheet, sizing_field(sheet, kept, side, options), required, most_triangles);
  };
  return method;
}

}  // namespace paperbake
