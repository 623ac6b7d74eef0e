#include "baker/render_pass.h"

#include "baker/cache_measure.h"
#include "core/cpu_clock.h"
#include "core/locate.h"

#include <algorithm>
#include <deque>
#include <future>
#include <optional>

namespace paperbake {
namespace {

struct Shown {
  RenderFrame frame;
  RenderNumbers numbers;  // of a frame that is wanted
};

/// Frames of a record on the render mesh, some of them ahead of the one that is asked for: each on a thread of its own.
class Renderer {
 public:
  Renderer(const ShotRecord& record, const Shot& shot, RenderSheet& sheet, const FrameSpan& wanted, int threads)
      : record_(record), shot_(shot), sheet_(sheet), wanted_(wanted), threads_(std::max(threads, 1)) {}

  /// The k-th of the record; k grows from call to call.
  Shown operator()(std::size_t k) {
    while (!coming_.empty() && coming_.front().k < k) coming_.pop_front();  // waits for it
    for (next_ = std::max(next_, k); next_ < record_.frames().size() && (coming_.size() < threads_ || next_ == k); ++next_)
      if (is_needed(next_) && !begin(next_)) break;
    Shown shown = coming_.front().shown.get();
    coming_.pop_front();
    return shown;
  }

 private:
  struct Coming {
    std::size_t k;
    std::future<Shown> shown;
  };
  using Places = std::shared_future<std::vector<Place>>;

  /// It, or the one before or after it, is wanted.
  bool is_needed(std::size_t k) const {
    const auto& frames = record_.frames();
    const auto wanted = [&](std::size_t i) { return i < frames.size() && wanted_.contains(frames[i].frame); };
    return wanted(k) || wanted(k + 1) || wanted(k - 1);
  }

  /// False: others are on the way, with other handles held.
  bool begin(std::size_t k) {
    const RecordedFrame& recorded = record_.frames()[k];
    if (held_ != recorded.held) {
      if (!coming_.empty()) return false;
      sheet_.hold(recorded.held);  // dear, but seldom: no frame's time
      held_ = recorded.held;
    }
    if (recorded.mesh != mesh_)
      places_ = std::async(std::launch::deferred, [this, mesh = recorded.mesh] { return sheet_.places_on(record_.meshes()[mesh].pattern, record_.meshes()[mesh].triangles); }).share();
    mesh_ = recorded.mesh;
    coming_.push_back({k, std::async(threads_ > 1 ? std::launch::async : std::launch::deferred, [this, &recorded, places = places_] { return render(recorded, places); })});
    return true;
  }

  Shown render(const RecordedFrame& recorded, const Places& places) const {
    const double begun = cpu_ms();
    const Sheet simulated = record_.sheet(recorded);
    Shown shown{sheet_.frame(simulated, places.get(), recorded.held_at), {}};
    if (shot_.colliders) keep_out(simulated, places.get(), poses_at(*shot_.colliders, recorded.frame - record_.frames().front().frame), shown.frame.x);
    if (wanted_.contains(recorded.frame)) shown.numbers = judge(shown.frame, cpu_ms() - begun);
    return shown;
  }

  /// The curved surface goes beyond its facets: where they lie on something, into it.
  void keep_out(const Sheet& simulated, const std::vector<Place>& places, const Poses& poses, Points3& x) const {
    Points3 on_facets = x;  // middles of a finer mesh are near enough
    for (std::size_t v = 0; v < places.size(); ++v) on_facets.row(v) = interpolate(places[v], simulated.triangles, simulated.x);
    push_out(*shot_.colliders, poses, on_facets, 0, x);
  }

  RenderNumbers judge(const RenderFrame& frame, double ms) const {
    const RenderMesh& mesh = sheet_.mesh();
    const double side = longer_side(shot_.pattern);
    CacheFrame stored;
    stored.x = frame.x;
    stored.triangles = mesh.triangles;
    stored.uv = mesh.pattern / side;
    const LengthDistortion length = cache_distortion(stored, side);
    return {static_cast<int>(mesh.triangles.rows()), 100 * length.mean, 100 * length.largest, ms, sheet_.crossings(frame.x.cast<float>().cast<double>()), frame.kept_apart};
  }

  const ShotRecord& record_;
  const Shot& shot_;
  RenderSheet& sheet_;
  const FrameSpan& wanted_;
  const std::size_t threads_;
  std::optional<std::vector<int>> held_;
  int mesh_ = -1;
  Places places_;
  std::size_t next_ = 0;         // to be begun
  std::deque<Coming> coming_;    // in order
};

}  // namespace

void render_shot(const ShotRecord& record, const Shot& shot, Quality quality, const FrameSpan& frames, double fps, int threads, const LayersOfFrame& layers,
                 const std::function<void(int frame, const CacheFrame&, const RenderNumbers&)>& write) {
  const auto& recorded = record.frames();
  if (recorded.empty()) return;
  RenderSheet render = make_render_sheet(shot.pattern, record.features(shot), record.edge(), quality);
  Renderer renderer(record, shot, render, frames, threads);
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
    if (k > 0 && !before) before = renderer(k - 1);
    if (!now) now = renderer(k);
    if (k < last) next = renderer(k + 1);
    const RenderFrame& shown = now->frame;
    if (before && next) cached.velocity = 0.5 * fps * (next->frame.x - before->frame.x);
    else if (next) cached.velocity = fps * (next->frame.x - shown.x);
    else if (before) cached.velocity = fps * (shown.x - before->frame.x);
    else cached.velocity = Points3::Zero(shown.x.rows(), 3);
    cached.x = shown.x;
    cached.normal = shown.normals;
    cached.crease = shown.crease;
    if (layers) cached.layers = layers(k, render.mesh().pattern);
    write(recorded[k].frame, cached, now->numbers);
  }
}

}  // namespace paperbake
