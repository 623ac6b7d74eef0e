#include "core/methods/adaptive.h"

#include "core/geometry/edge_operations.h"
#include "core/geometry/pattern_mesh.h"
#include "core/methods/adaptive_mesh/sizing_field.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

enum class Pass { both_ways, coarsen };

/// True if changing the mesh is worth it: after every change the sheet needs some iterations to
/// come to rest again.
bool is_due(const Sheet& sheet, const Points3& metric) {
  constexpr double far_too_long = 1.25;  // [1] metric length of an edge
  constexpr double many = 0.01;          // [1] of the edges
  constexpr double too_many = 1.3;       // [1] of the triangles that the field asks for
  const Misfit now = misfit(sheet, metric);
  return now.longest > far_too_long || now.too_long > many ||
         sheet.triangles.rows() > too_many * triangles_of(sheet, metric);
}

/// One pass over a sheet at rest on its mesh. The mesh may become twice as fine in it, but no
/// finer.
/// returns  whether the mesh changed
bool adapt(Sheet& sheet, Points3 metric, int fixed, int max_triangles, Pass pass) {
  // [1] of the length at which edges are split: what was split is not collapsed again
  constexpr double joined_below = 0.8;
  constexpr int rounds_of_splits = 2;
  const int rounds_of_collapses = pass == Pass::both_ways ? 3 : 10;
  // a field that asks for too many triangles is coarsened as a whole
  metric *= std::min(1.0, max_triangles / triangles_of(sheet, metric));
  if (!is_due(sheet, metric)) return false;
  bool changed = false;
  for (int round = 0; pass == Pass::both_ways && round < rounds_of_splits; ++round) {
    const int splits = split_long_edges(sheet, metric, max_triangles);
    changed |= flip_to_delaunay(sheet, metric) > 0 || splits > 0;
    if (splits == 0) break;
  }
  for (int round = 0; round < rounds_of_collapses; ++round) {
    std::vector<char> kept(sheet.pattern.rows(), 0);
    std::fill_n(kept.begin(), fixed, 1);
    if (collapse_short_edges(sheet, metric, kept, joined_below) == 0) break;
    flip_to_delaunay(sheet, metric);
    changed = true;
  }
  return changed;
}

class Adaptive : public Method {
 public:
  Adaptive(double side, int max_triangles, const SizingOptions& options)
      : side_(side), max_triangles_(max_triangles), options_(options) {}

  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    PatternMesh mesh = mesh_pattern(pattern, first_edge(pattern), points, options_.turn);
    number_points_first(mesh);
    return mesh;
  }
  std::optional<PatternMesh> mesh_with_creases(const Pattern& pattern,
                                               const std::vector<Vector2d>& points,
                                               int refinement) const override {
    std::optional<PatternMesh> mesh = try_mesh_pattern(
        pattern, first_edge(pattern) / std::sqrt(refinement), points, options_.turn);
    if (mesh) number_points_first(*mesh);
    return mesh;
  }

  MeshChange remesh(Sheet& sheet, const RemeshContext& context) override {
    // A jump is followed in many steps, and the shape after it has little to do with the one that
    // the mesh is fine for now.
    constexpr double jump_threshold = 0.1;  // [1] of the longer side
    constexpr int max_triangles_after_jump = 400;
    const bool jumps = context.relative_handle_motion > jump_threshold;
    // nor is a shape on its way to the minimum a reason for more triangles
    if (!jumps && (!context.at_minimum || !(context.moving || unfinished_)))
      return MeshChange::none;
    const Points3 kept = context.plastic_grid
                             ? context.plastic_grid->at_vertices(sheet.pattern, sheet.triangles)
                             : Points3(0, 3);
    const int required =
        static_cast<int>(std::count(context.fixed.begin(), context.fixed.end(), 1));
    const Points3 metric = sizing_field(sheet, kept, side_, options_);
    const bool changed =
        jumps ? adapt(sheet, metric, required, std::min(max_triangles_, max_triangles_after_jump),
                      Pass::coarsen)
              : adapt(sheet, metric, required, max_triangles_, Pass::both_ways);
    unfinished_ = changed || (jumps && unfinished_);
    return changed ? MeshChange::local : MeshChange::none;
  }

  void archive(Serializer& a) override { a(unfinished_); }

 private:
  /// [m] Mean edge of a mesh in which none is so long that it would be split.
  double first_edge(const Pattern& pattern) const {
    constexpr double mean_edge = 0.8;  // [1] of the longest edge that is not split
    return mean_edge * options_.largest * std::sqrt(area(pattern));
  }
  double side_;  // [m] longer side of the pattern
  int max_triangles_;
  SizingOptions options_;
  bool unfinished_ = true;  // the last pass changed the mesh
};

}  // namespace

MethodChoice adaptive(const Pattern& pattern, int max_triangles, const SizingOptions& options) {
  return {"adaptive", [=, side = longer_side(pattern)] {
            return std::make_unique<Adaptive>(side, max_triangles, options);
          }};
}

}  // namespace paperbake
