#include "baker/bake/push_out_of_colliders.h"

#include "core/geometry/box_of.h"
#include "core/step1_elastic/elastic.h"

#include <cmath>
#include <optional>

namespace paperbake {
namespace {

/// Whether a collider reaches into the box round the points, or is closer to it than `within` [m].
bool may_touch(const ColliderShapes& shapes, const Points3& x, double within) {
  const Eigen::AlignedBox3d near = grown(box_of(x), within);
  bool any = false;
  for (const auto& shape : shapes) shape->triangle_tree().visit(near, [&](int) { any = true; });
  return any;
}

/// Puts held vertices back. returns  [m] how far the farthest of the others has gone
double keep_held(const std::vector<char>& held, const Points3& before, Points3& x) {
  double farthest = 0;
  for (int v = 0; v < x.rows(); ++v)
    if (held[v])
      x.row(v) = before.row(v);
    else
      farthest = std::max(farthest, (x.row(v) - before.row(v)).squaredNorm());
  return std::sqrt(farthest);
}

}  // namespace

bool push_out_of_colliders(const SheetAmongColliders& sheet, double clearance, Points3& x) {
  const RenderSurface& surface = sheet.surface;
  const ColliderShapes shapes = shapes_at(*sheet.colliders, sheet.row);
  const Points3 on_triangles =
      surface.linear_positions(sheet.simulated.sheet, *sheet.simulated.places);
  Points3 outside = on_triangles;
  if (push_out(shapes, on_triangles, 0, outside) > give_way_depth) return false;
  // vertices first, then edges and triangles: a corner of the collider stands between vertices
  std::optional<ColliderClearance> features;
  if (may_touch(shapes, x, clearance))
    features.emplace(sheet.colliders, shapes, surface.mesh().triangles, on_triangles);
  if (features && features->begins_inside() > give_way_depth) return false;
  constexpr int max_turns = 8;
  constexpr double still = 1e-6;  // [m] what is pushed by less needs no other turn
  const std::vector<char>& held = surface.is_held();
  for (int turn = 0;; ++turn, clearance /= 2) {
    const Points3 before = x;
    push_out(shapes, on_triangles, clearance, x);
    keep_held(held, before, x);
    if (features) features->push_out(held, clearance, x);
    const double pushed = keep_held(held, before, x);
    if (pushed < still || turn == max_turns) return turn > 0 || pushed > 0;
    surface.limit_strain(x);
  }
}

}  // namespace paperbake
