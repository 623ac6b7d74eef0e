#include "baker/bake/render_pass.h"

#include "baker/output/cache_measure.h"
#include "core/animation/cpu_clock.h"
#include "core/geometry/point_location.h"
#include "core/render/untangle_sheets.h"

#include <algorithm>
#include <deque>
#include <future>
#include <optional>

namespace paperbake {
namespace {

/// One frame of every sheet; in front those that have it, of a bake that ended between two sheets.
struct RenderedFrame {
  std::vector<RenderFrame> frames;
  std::vector<RenderStatistics> statistics;  // of a frame that is wanted
};

/// Where the vertices of a render mesh lie on the mesh of the frame that was asked for last.
class MeshPointCache {
 public:
  using Places = std::shared_future<std::vector<MeshPoint>>;
  MeshPointCache(const ShotRecord& record, const RenderSurface& sheet)
      : record_(&record), sheet_(&sheet) {}

  const Places& at(std::size_t k) {
    const int mesh = record_->frames()[k].mesh;
    if (mesh != mesh_) {
      const ShotRecord::Mesh& simulated = record_->meshes()[mesh];
      places_ = std::async(std::launch::deferred, [sheet = sheet_, &simulated] {
                  return sheet->locate_on(simulated.pattern, simulated.triangles);
                }).share();
    }
    mesh_ = mesh;
    return places_;
  }

 private:
  const ShotRecord* record_;
  const RenderSurface* sheet_;
  int mesh_ = -1;
  Places places_;
};

std::size_t frames_of_any(const std::vector<RenderInput>& sheets) {
  std::size_t count = 0;
  for (const RenderInput& sheet : sheets) count = std::max(count, sheet.record->frames().size());
  return count;
}

/// Frames of records on the render meshes, some of them ahead of the one that is asked for: each on
/// a thread of its own.
class Renderer {
 public:
  Renderer(const std::vector<RenderInput>& shown, std::vector<RenderSurface>& sheets,
           const FrameSpan& wanted, int threads)
      : shown_(shown),
        sheets_(sheets),
        together_(sheets),
        wanted_(wanted),
        threads_(std::max(threads, 1)),
        held_(sheets.size()) {
    for (std::size_t s = 0; s < sheets.size(); ++s)
      places_.emplace_back(*shown[s].record, sheets[s]);
  }

  /// The k-th of the records; k grows from call to call.
  RenderedFrame operator()(std::size_t k) {
    while (!pending_.empty() && pending_.front().k < k) pending_.pop_front();  // waits for it
    for (next_ = std::max(next_, k);
         next_ < frames_of_any(shown_) && (pending_.size() < threads_ || next_ == k); ++next_)
      if (is_needed(next_) && !start(next_)) break;
    RenderedFrame shown = pending_.front().rendered.get();
    pending_.pop_front();
    return shown;
  }

 private:
  struct PendingFrame {
    std::size_t k;
    std::future<RenderedFrame> rendered;
  };

  /// Sheets that have a k-th frame: the first ones.
  std::size_t sheets_with_frame(std::size_t k) const {
    std::size_t count = 0;
    while (count < shown_.size() && k < shown_[count].record->frames().size()) ++count;
    return count;
  }

  /// It, or the one before or after it, is wanted.
  bool is_needed(std::size_t k) const {
    const auto& frames = shown_.front().record->frames();
    const auto wanted = [&](std::size_t i) {
      return i < frames.size() && wanted_.contains(frames[i].frame);
    };
    return wanted(k) || wanted(k + 1) || wanted(k - 1);
  }

  /// False: others are on the way, with other handles held.
  bool start(std::size_t k) {
    std::vector<MeshPointCache::Places> places;
    for (std::size_t s = 0; s < sheets_with_frame(k); ++s) {
      const RecordedFrame& recorded = shown_[s].record->frames()[k];
      if (held_[s] != recorded.held) {
        if (!pending_.empty()) return false;
        sheets_[s].hold(recorded.held);  // dear, but seldom: no frame's time
        held_[s] = recorded.held;
      }
    }
    for (std::size_t s = 0; s < sheets_with_frame(k); ++s) places.push_back(places_[s].at(k));
    pending_.push_back({k, std::async(threads_ > 1 ? std::launch::async : std::launch::deferred,
                                      [this, k, places] { return render(k, places); })});
    return true;
  }

  RenderedFrame render(std::size_t k, const std::vector<MeshPointCache::Places>& places) const {
    RenderedFrame shown;
    std::vector<SheetUntangler::Simulated> simulated;
    std::vector<double> ms;
    for (std::size_t s = 0; s < places.size(); ++s) {
      const double start_ms = cpu_ms();
      const RecordedFrame& recorded = shown_[s].record->frames()[k];
      simulated.push_back({shown_[s].record->sheet(recorded), &places[s].get()});
      shown.frames.push_back(
          sheets_[s].frame(simulated[s].sheet, *simulated[s].places, recorded.held_at));
      ms.push_back(cpu_ms() - start_ms);
    }
    const double start_ms = cpu_ms();
    if (shown.frames.size() == sheets_.size()) together_.keep_apart(shown.frames, simulated);
    const double each_ms = (cpu_ms() - start_ms) / std::max<std::size_t>(1, places.size());
    for (std::size_t s = 0; s < places.size(); ++s) {
      const double start_ms = cpu_ms();
      push_out_of_colliders(s, k, simulated[s], shown.frames[s].x);
      ms[s] += each_ms + cpu_ms() - start_ms;
    }
    if (wanted_.contains(shown_.front().record->frames()[k].frame))
      shown.statistics = measure(shown.frames, ms);
    return shown;
  }

  /// The curved surface goes beyond its facets: where they lie on something, into it.
  void push_out_of_colliders(std::size_t s, std::size_t k,
                             const SheetUntangler::Simulated& simulated, Points3& x) const {
    const auto& colliders = shown_[s].shot->colliders;
    if (!colliders) return;
    const auto& frames = shown_[s].record->frames();
    Points3 on_facets = x;  // middles of a finer mesh are near enough
    for (std::size_t v = 0; v < simulated.places->size(); ++v)
      on_facets.row(v) =
          interpolate((*simulated.places)[v], simulated.sheet.triangles, simulated.sheet.x);
    push_out(*colliders, poses_at(*colliders, frames[k].frame - frames.front().frame), on_facets, 0,
             x);
  }

  std::vector<RenderStatistics> measure(const std::vector<RenderFrame>& frames,
                                        const std::vector<double>& ms) const {
    std::vector<RenderStatistics> statistics;
    std::vector<Points3> stored_x;
    for (std::size_t s = 0; s < frames.size(); ++s) {
      const RenderMesh& mesh = sheets_[s].mesh();
      const double side = longer_side(shown_[s].shot->pattern);
      CacheFrame stored;
      stored.x = frames[s].x;
      stored.triangles = mesh.triangles;
      stored.uv = mesh.pattern / side;
      const LengthDistortion length = cache_distortion(stored, side);
      stored_x.push_back(frames[s].x.cast<float>().cast<double>());
      RenderStatistics& sheet = statistics.emplace_back();
      sheet.triangles = static_cast<int>(mesh.triangles.rows());
      sheet.stretch_mean = length.mean;
      sheet.stretch_max = length.largest;
      sheet.ms = ms[s];
      sheet.crossings = sheets_[s].crossings(stored_x[s]);
      sheet.kept_apart = frames[s].kept_apart;
    }
    const std::vector<int> with_others = together_.crossings(stored_x);
    for (std::size_t s = 0; s < frames.size(); ++s)
      statistics[s].crossings_with_others = with_others[s];
    return statistics;
  }

  const std::vector<RenderInput>& shown_;
  std::vector<RenderSurface>& sheets_;
  const SheetUntangler together_;
  const FrameSpan& wanted_;
  const std::size_t threads_;
  std::vector<std::optional<std::vector<int>>> held_;
  std::vector<MeshPointCache> places_;
  std::size_t next_ = 0;              // to be start_ms
  std::deque<PendingFrame> pending_;  // in order
};

/// Some frame passes through itself, or through another, however far the render meshes go back.
bool cut_through(const std::vector<RenderInput>& shown, const std::vector<RenderSurface>& sheets,
                 std::size_t threads) {
  const SheetUntangler together(sheets);
  std::vector<MeshPointCache> places;
  for (std::size_t s = 0; s < sheets.size(); ++s) places.emplace_back(*shown[s].record, sheets[s]);
  const auto is_cut = [&](std::size_t k, const std::vector<MeshPointCache::Places>& at) {
    std::vector<SheetUntangler::Simulated> simulated;
    for (std::size_t s = 0; s < at.size(); ++s) {
      simulated.push_back({shown[s].record->sheet(shown[s].record->frames()[k]), &at[s].get()});
      if (sheets[s].linear_surface_intersects(simulated[s].sheet, *simulated[s].places))
        return true;
    }
    return simulated.size() == sheets.size() && together.linear_surfaces_intersect(simulated);
  };
  std::deque<std::future<bool>> pending;
  bool cut = false;
  for (std::size_t k = frames_of_any(shown); k-- > 0 && !cut;) {  // the tightest come last
    std::vector<MeshPointCache::Places> at;
    for (std::size_t s = 0; s < sheets.size() && k < shown[s].record->frames().size(); ++s)
      at.push_back(places[s].at(k));
    pending.push_back(std::async(threads > 1 ? std::launch::async : std::launch::deferred,
                                 [&is_cut, k, at] { return is_cut(k, at); }));
    if (pending.size() < threads) continue;
    cut = pending.front().get();
    pending.pop_front();
  }
  for (std::future<bool>& other : pending) cut |= other.get();
  return cut;
}

std::vector<RenderSurface> render_sheets(const std::vector<RenderInput>& shown, Quality quality,
                                         int threads) {
  enum class Edges { some, all };
  const auto make = [&](Edges edges) {
    std::vector<RenderSurface> sheets;
    for (const RenderInput& sheet : shown) {
      RenderFeatures features = sheet.record->features(*sheet.shot);
      if (edges == Edges::all) features.edges = sheet.record->edges();
      sheets.push_back(
          make_render_surface(sheet.shot->pattern, features, sheet.record->edge(), quality));
    }
    return sheets;
  };
  std::vector<RenderSurface> sheets = make(Edges::some);
  return cut_through(shown, sheets, std::max(threads, 1)) ? make(Edges::all) : std::move(sheets);
}

Points3 velocity_of(const std::optional<RenderedFrame>& before, const RenderedFrame& now,
                    const std::optional<RenderedFrame>& next, std::size_t s, double fps) {
  const auto has = [&](const std::optional<RenderedFrame>& other) {
    return other && s < other->frames.size();
  };
  const Points3& x = now.frames[s].x;
  if (has(before) && has(next)) return 0.5 * fps * (next->frames[s].x - before->frames[s].x);
  if (has(next)) return fps * (next->frames[s].x - x);
  if (has(before)) return fps * (x - before->frames[s].x);
  return Points3::Zero(x.rows(), 3);
}

}  // namespace

void render_shot(const std::vector<RenderInput>& sheets, Quality quality, const FrameSpan& frames,
                 double fps, int threads) {
  const auto& recorded = sheets.front().record->frames();
  if (recorded.empty()) return;
  std::vector<RenderSurface> renders = render_sheets(sheets, quality, threads);
  Renderer renderer(sheets, renders, frames, threads);
  std::vector<CacheFrame> cached(sheets.size());
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    cached[s].triangles = renders[s].mesh().triangles;
    cached[s].normal_of_corner = renders[s].normal_of_corner();
    cached[s].uv = renders[s].mesh().pattern / longer_side(sheets[s].shot->pattern);
  }

  std::optional<RenderedFrame> before, now, next;
  const int last = static_cast<int>(recorded.size()) - 1;
  for (int k = 0; k <= last; ++k) {
    before = std::move(now);
    now = std::move(next);
    next.reset();
    if (!frames.contains(recorded[k].frame)) continue;
    if (k > 0 && !before) before = renderer(k - 1);
    if (!now) now = renderer(k);
    if (k < last) next = renderer(k + 1);
    for (std::size_t s = 0; s < now->frames.size(); ++s) {
      cached[s].velocity = velocity_of(before, *now, next, s, fps);
      cached[s].x = now->frames[s].x;
      cached[s].normal = now->frames[s].normals;
      cached[s].crease = now->frames[s].crease;
      if (sheets[s].layers) cached[s].layers = sheets[s].layers(k, renders[s].mesh().pattern);
      sheets[s].write(recorded[k].frame, cached[s], now->statistics[s]);
    }
  }
}

std::vector<std::vector<std::size_t>> near_each_other(
    const std::vector<const ShotRecord*>& records) {
  std::vector<std::vector<Eigen::AlignedBox3f>> boxes(records.size());
  for (std::size_t s = 0; s < records.size(); ++s)
    for (const RecordedFrame& frame : records[s]->frames()) {
      // what is curved stands out from its facets by less than half an edge
      const Eigen::Vector3f off =
          Eigen::Vector3f::Constant(static_cast<float>(0.5 * records[s]->edge()));
      boxes[s].emplace_back(frame.x.colwise().minCoeff().transpose() - off,
                            frame.x.colwise().maxCoeff().transpose() + off);
    }
  const auto near = [&](std::size_t s, std::size_t t) {
    for (std::size_t k = 0; k < std::min(boxes[s].size(), boxes[t].size()); ++k)
      if (boxes[s][k].intersects(boxes[t][k])) return true;
    return false;
  };
  std::vector<std::size_t> first(records.size());  // of the list that it is in
  for (std::size_t s = 0; s < records.size(); ++s) {
    first[s] = s;
    for (std::size_t t = 0; t < s; ++t)
      if (const std::size_t a = std::min(first[s], first[t]), b = std::max(first[s], first[t]);
          a != b && near(s, t))
        std::replace(first.begin(), first.begin() + s + 1, b, a);
  }
  std::vector<std::vector<std::size_t>> lists;
  for (std::size_t f = 0; f < records.size(); ++f) {
    std::vector<std::size_t> list;
    for (std::size_t s = 0; s < records.size(); ++s)
      if (first[s] == f) list.push_back(s);
    if (!list.empty()) lists.push_back(list);
  }
  return lists;
}

}  // namespace paperbake
