#include "baker/render_pass.h"

#include "baker/cache_measure.h"
#include "core/cpu_clock.h"
#include "core/locate.h"

#include <optional>

namespace paperbake {
namespace {

struct Shown {
  RenderFrame frame;
  double ms;
};

/// Frames of a record on the render mesh, asked for in order.
class Renderer {
 public:
  Renderer(const ShotRecord& record, const Shot& shot, RenderSheet& sheet) : record_(record), colliders_(shot.colliders.get()), sheet_(sheet) {}

  Shown operator()(const RecordedFrame& recorded) {
    sheet_.hold(recorded.held);  // dear, but seldom: not this frame's time
    const double begun = cpu_ms();
    const Sheet simulated = record_.sheet(recorded);
    if (recorded.mesh != mesh_) places_ = sheet_.places_on(simulated.pattern, simulated.triangles);
    mesh_ = recorded.mesh;
    RenderFrame frame = sheet_.frame(simulated, places_, recorded.held_at);
    if (colliders_) keep_out(simulated, poses_at(*colliders_, recorded.frame - record_.frames().front().frame), frame.x);
    return {std::move(frame), cpu_ms() - begun};
  }

 private:
  /// The curved surface goes beyond its facets: where they lie on something, into it.
  void keep_out(const Sheet& simulated, const Poses& poses, Points3& x) const {
    Points3 on_facets = x;  // middles of a finer mesh are near enough
    for (std::size_t v = 0; v < places_.size(); ++v) on_facets.row(v) = interpolate(places_[v], simulated.triangles, simulated.x);
    push_out(*colliders_, poses, on_facets, 0, x);
  }

  const ShotRecord& record_;
  const Colliders* colliders_;   // null: there are none
  RenderSheet& sheet_;
  int mesh_ = -1;
  std::vector<Place> places_;
};

RenderNumbers judge(const CacheFrame& frame, double longer_side, const RenderSheet& render, const Shown& shown) {
  const LengthDistortion length = cache_distortion(frame, longer_side);
  const Points3 stored = frame.x.cast<float>().cast<double>();
  return {static_cast<int>(frame.triangles.rows()), 100 * length.mean, 100 * length.largest, shown.ms, render.crossings(stored), shown.frame.kept_apart};
}

}  // namespace

void render_shot(const ShotRecord& record, const Shot& shot, Quality quality, const FrameSpan& frames, double fps, const LayersOfFrame& layers,
                 const std::function<void(int frame, const CacheFrame&, const RenderNumbers&)>& write) {
  const auto& recorded = record.frames();
  if (recorded.empty()) return;
  RenderSheet render = make_render_sheet(shot.pattern, record.features(shot), record.edge(), quality);
  Renderer renderer(record, shot, render);
  CacheFrame cached;
  cached.triangles = render.mesh().triangles;
  cached.normal_of_corner = render.normal_of_corner();
  cached.uv = render.mesh().pattern / longer_side(shot.pattern);

  std::optional<Shown> before, now, next;
  const int last = static_cast<int>(recorded.size()) - 1;
  for (int k = 0; k <= last; ++k) {
    before = std::move(now);
    now = std::move(next);
    next.reset();
    if (!frames.contains(recorded[k].frame)) continue;
    if (k > 0 && !before) before = renderer(recorded[k - 1]);
    if (!now) now = renderer(recorded[k]);
    if (k < last) next = renderer(recorded[k + 1]);
    const RenderFrame& shown = now->frame;
    if (before && next) cached.velocity = 0.5 * fps * (next->frame.x - before->frame.x);
    else if (next) cached.velocity = fps * (next->frame.x - shown.x);
    else if (before) cached.velocity = fps * (shown.x - before->frame.x);
    else cached.velocity = Points3::Zero(shown.x.rows(), 3);
    cached.x = shown.x;
    cached.normal = shown.normals;
    cached.crease = shown.crease;
    if (layers) cached.layers = layers(k, render.mesh().pattern);
    write(recorded[k].frame, cached, judge(cached, longer_side(shot.pattern), render, *now));
  }
}

}  // namespace paperbake
