#include "baker/bake/simulation_cache.h"

#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/geometry/surface_transfer.h"

namespace paperbake {

SimulationCache::SimulationCache(const BakeContext& bake, std::size_t sheet)
    : bake_(bake), sheet_(sheet) {
  if (const auto& colliders = bake.plan.shots[sheet].colliders)
    colliders_ = std::make_shared<const JudgedColliders>(*colliders);
  if (bake.plan.guides) guides_.emplace(bake.plan.shots[sheet]);
}

void SimulationCache::consume(const AnimatedFrame& frame) {
  flush_deferred(frame.sheet);
  before_ = std::move(now_);
  now_ = *frame.sheet;
  if (guides_) guides_->add(frame);
  if (bake_.plan.frames.contains(frame.frame)) defer(frame);
}

void SimulationCache::defer(const AnimatedFrame& frame) {
  const Sheet& sheet = *frame.sheet;
  CacheFrame& cached = deferred_.emplace();
  cached.x = sheet.x;
  cached.normal = vertex_normals(sheet.x, sheet.triangles);
  cached.triangles = sheet.triangles;
  cached.uv = sheet.pattern / longer_side(bake_.plan.shots[sheet_].pattern);
  if (const auto& authored = bake_.plan.shots[sheet_].authored)
    cached.surface =
        std::make_shared<const MeshSurface>(surface_on(*authored, sheet.pattern, sheet.triangles));
  cached.velocity = sheet.v;  // backward difference, where neighbours cannot be compared
  deferred_frame_ = frame.frame;
}

/// Gives the deferred frame the central difference of the true motion of the sheet points that are
/// its vertices, and hands it on. next: the sheet one frame later; null at the end of the shot
void SimulationCache::flush_deferred(const Sheet* next) {
  if (!deferred_) return;
  const double fps = bake_.plan.animation.fps;
  const bool has_before = before_.x.rows() > 0;
  if (has_before && next)
    deferred_->velocity = 0.5 * fps * (resample(*next) - resample(before_));
  else if (next)
    deferred_->velocity = fps * (resample(*next) - now_.x);
  else if (has_before)
    deferred_->velocity = fps * (now_.x - resample(before_));

  FrameRecord& line = bake_.certificate.line(sheet_, deferred_frame_);
  const CacheJudge judge(deferred_->uv, deferred_->triangles,
                         longer_side(bake_.plan.shots[sheet_].pattern), colliders_);
  const Judgement judgement =
      judge(deferred_->x, deferred_frame_ - bake_.plan.animation.first_frame);
  RenderStatistics& render = line.statistics.render.emplace(statistics_of(judgement, judge));
  enter(judgement, line);
  render.crossings_with_others = line.statistics.crossings_with_others;
  if (guides_) deferred_->guides = guides_->at(deferred_frame_, *deferred_);
  line.content_hash = bake_.caches.add_frame(sheet_, deferred_frame_, *deferred_);
  deferred_.reset();
}

/// Positions in another frame, whatever its mesh, of the points that are vertices of now_.
/// |V|x3 [m]
Points3 SimulationCache::resample(const Sheet& other) const {
  const bool same = same_entries(other.pattern, now_.pattern);
  return same ? other.x : MeshTransfer(other.pattern, other.triangles, now_.pattern)(other.x);
}

}  // namespace paperbake
