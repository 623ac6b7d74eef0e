#include "baker/bake/render_shapes.h"

#include "core/render/mesh_changes.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// [frames] for how long before and after a change of the simulated mesh what it moves is spread.
/// Meshes change every few frames: with half of it the sheet still jumps, and twice as much gains
/// little, but keeps more of the old shape in a shot that is fast.
int half_of_change(double fps) {
  constexpr double half = 8 / 24.0;  // [s]
  return std::max(1, static_cast<int>(std::lround(half * fps)));
}

}  // namespace

MeshPoints MeshPointCache::at(std::size_t k) {
  const int mesh = record_->frames()[k].mesh;
  MeshPoints& points = points_[mesh];
  if (!points.valid()) {
    const ShotRecord::Mesh& simulated = record_->meshes()[mesh];
    points = std::async(std::launch::deferred, [surface = surface_, &simulated] {
               return surface->locate_on(simulated.pattern, simulated.triangles);
             }).share();
  }
  return points;
}

void MeshPointCache::forget_before(std::size_t k) {
  points_.erase(points_.begin(), points_.lower_bound(record_->frames()[k].mesh));
}

ShapeCache::ShapeCache(const ShotRecord& record, const RenderSurface& surface, double fps)
    : record_(&record), surface_(&surface), half_(half_of_change(fps)), points_(record, surface) {}

RenderSurface::Shape ShapeCache::Sum::operator()() const {
  RenderSurface::Shape shape = shape_.get();
  if (changes_.empty()) return shape;
  Points3 seen = Points3::Zero(3 * triangles_->rows(), 3);
  for (const auto& [change, share] : changes_) {
    seen += share * (share > 0 ? change.get().seen_before : change.get().seen_after);
    shape.curvature += share * change.get().curvature;
  }
  shape.x += seen_from_outside(*triangles_, shape.x, seen);
  return shape;
}

ShapeCache::Sum ShapeCache::at(std::size_t k) {
  const std::size_t first = k - std::min(k, static_cast<std::size_t>(half_));
  shapes_.erase(shapes_.begin(), shapes_.lower_bound(k));
  changes_.erase(changes_.begin(), changes_.lower_bound(first));
  points_.forget_before(first);
  Sum sum;
  sum.points_ = points_.at(k);
  sum.shape_ = shape(k);
  for (const auto& [frame, share] : mesh_changes_near(*record_, k, half_))
    sum.changes_.emplace_back(change(frame), share);
  sum.triangles_ = &surface_->triangles_of_shape();
  return sum;
}

std::shared_future<RenderSurface::Shape> ShapeCache::shape(std::size_t k) {
  std::shared_future<RenderSurface::Shape>& known = shapes_[k];
  if (!known.valid())
    known = std::async(std::launch::deferred, [record = record_, surface = surface_, k,
                                               points = points_.at(k)] {
              return surface->shape(record->sheet(record->frames()[k]), points.get());
            }).share();
  return known;
}

std::shared_future<ShapeCache::Change> ShapeCache::change(std::size_t k) {
  std::shared_future<Change>& known = changes_[k];
  if (known.valid()) return known;
  return known =
             std::async(std::launch::deferred, [record = record_, surface = surface_, k,
                                                points = points_.at(k), before = shape(k - 1)] {
               const Triangles& triangles = surface->triangles_of_shape();
               const RenderSurface::Shape &old = before.get(),
                                          after = surface->shape(
                                              record->carried(record->frames()[k]), points.get());
               const Points3 displacement = after.x - old.x;
               return Change{seen_by_triangles(triangles, old.x, displacement),
                             seen_by_triangles(triangles, after.x, displacement),
                             after.curvature - old.curvature};
             }).share();
}

}  // namespace paperbake
