#include "baker/bake/render_pass.h"

#include "core/animation/cpu_clock.h"
#include "core/geometry/collider.h"
#include "core/geometry/point_location.h"
#include "core/geometry/surface_transfer.h"
#include "core/render/mesh_changes.h"
#include "core/render/render_surface.h"
#include "core/render/untangle_sheets.h"
#include "core/step1_elastic/elastic.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <future>
#include <map>
#include <optional>
#include <set>

namespace paperbake {
namespace {

using MeshPoints = std::shared_future<std::vector<MeshPoint>>;
using Shape = RenderSurface::Shape;

/// How many sheets have a k-th frame: the first ones.
std::size_t sheets_with_frame(const std::vector<RenderInput>& sheets, std::size_t k) {
  std::size_t count = 0;
  while (count < sheets.size() && k < sheets[count].record->frames().size()) ++count;
  return count;
}

/// The k-th frame of all sheets has the shape of the one before.
bool simulated_alike(const std::vector<RenderInput>& sheets, std::size_t k) {
  if (k == 0 || sheets_with_frame(sheets, k) != sheets_with_frame(sheets, k - 1)) return false;
  for (std::size_t s = 0; s < sheets_with_frame(sheets, k); ++s) {
    const RecordedFrame &now = sheets[s].record->frames()[k],
                        &before = sheets[s].record->frames()[k - 1];
    if (now.mesh != before.mesh || now.x != before.x) return false;
  }
  return true;
}

std::size_t frames_of_any(const std::vector<RenderInput>& sheets) {
  std::size_t count = 0;
  for (const RenderInput& sheet : sheets) count = std::max(count, sheet.record->frames().size());
  return count;
}

/// Where to start work that may run on a thread of its own.
std::launch launch_policy(int threads) {
  return threads > 1 ? std::launch::async : std::launch::deferred;
}

/// [frames] for how long before and after a change of the simulated mesh what it moves is spread.
/// Meshes change every few frames: with half of it the sheet still jumps, and twice as much gains
/// little, but keeps more of the old shape in a shot that is fast.
int half_of_change(double fps) {
  constexpr double half = 8 / 24.0;  // [s]
  return std::max(1, static_cast<int>(std::lround(half * fps)));
}

/// Whether a collider reaches into the box round the points.
bool may_touch(const ColliderShapes& shapes, const Points3& x) {
  const Vector3d low = x.colwise().minCoeff(), high = x.colwise().maxCoeff();
  bool any = false;
  for (const auto& shape : shapes) shape->near_triangles(low, high, 0, [&](int) { any = true; });
  return any;
}

}  // namespace

/// Where the vertices of a render mesh lie on simulated meshes, those of the last frames that were
/// asked for.
class RenderPass::MeshPointCache {
 public:
  MeshPointCache(const ShotRecord& record, const RenderSurface& surface)
      : record_(&record), surface_(&surface) {}

  MeshPoints at(std::size_t k) {
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
  /// Meshes of frames before the k-th will not be asked for again.
  void forget_before(std::size_t k) {
    points_.erase(points_.begin(), points_.lower_bound(record_->frames()[k].mesh));
  }

 private:
  const ShotRecord* record_;
  const RenderSurface* surface_;
  std::map<int, MeshPoints> points_;  // of a mesh
};

/// The shapes of the frames of a sheet on its render mesh. What a change of the simulated mesh
/// moves is spread over the frames around it (mesh_changes.h).
class RenderPass::ShapeCache {
 public:
  /// half  [frames] as in mesh_changes_near
  ShapeCache(const ShotRecord& record, const RenderSurface& surface, int half)
      : record_(&record), surface_(&surface), half_(half), points_(record, surface) {}

  /// What a change of mesh moves, at the time of the last frame on the old mesh.
  struct Change {
    Points3 seen_before, seen_after;  // displacement (seen_by_triangles), on the old and new mesh
    Points3 curvature;                // |V|x3 [1/m]
  };
  /// Computes the shape of a frame when it is asked for. A sum of a shape and changes, which are
  /// shared with other frames.
  class Sum {
   public:
    const std::vector<MeshPoint>& places() const { return points_.get(); }
    Shape operator()() const {
      Shape shape = shape_.get();
      if (changes_.empty()) return shape;
      Points3 seen = Points3::Zero(3 * triangles_->rows(), 3);
      for (const auto& [change, share] : changes_) {
        seen += share * (share > 0 ? change.get().seen_before : change.get().seen_after);
        shape.curvature += share * change.get().curvature;
      }
      shape.x += seen_from_outside(*triangles_, shape.x, seen);
      return shape;
    }

   private:
    friend ShapeCache;
    MeshPoints points_;
    std::shared_future<Shape> shape_;
    std::vector<std::pair<std::shared_future<Change>, double>> changes_;
    const Triangles* triangles_ = nullptr;
  };

  /// k  may only grow
  Sum at(std::size_t k) {
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

 private:
  std::shared_future<Shape> shape(std::size_t k) {
    std::shared_future<Shape>& known = shapes_[k];
    if (!known.valid())
      known = std::async(std::launch::deferred, [record = record_, surface = surface_, k,
                                                 points = points_.at(k)] {
                return surface->shape(record->sheet(record->frames()[k]), points.get());
              }).share();
    return known;
  }

  /// The change of mesh before frame k.
  std::shared_future<Change> change(std::size_t k) {
    std::shared_future<Change>& known = changes_[k];
    if (known.valid()) return known;
    return known =
               std::async(std::launch::deferred, [record = record_, surface = surface_, k,
                                                  points = points_.at(k), before = shape(k - 1)] {
                 const Triangles& triangles = surface->triangles_of_shape();
                 const Shape &old = before.get(),
                             after =
                                 surface->shape(record->carried(record->frames()[k]), points.get());
                 const Points3 displacement = after.x - old.x;
                 return Change{seen_by_triangles(triangles, old.x, displacement),
                               seen_by_triangles(triangles, after.x, displacement),
                               after.curvature - old.curvature};
               }).share();
  }

  const ShotRecord* record_;
  const RenderSurface* surface_;
  int half_;
  MeshPointCache points_;
  std::map<std::size_t, std::shared_future<Shape>> shapes_;
  std::map<std::size_t, std::shared_future<Change>> changes_;
};

/// One frame of every sheet that has it, the first ones: a bake may have ended between two sheets.
struct RenderPass::FrameOfSheets {
  std::vector<RenderFrame> frames;
  struct Verdict {
    RenderStatistics statistics;
    Judgement judgement;
    double handle_error = 0;  // [m]
  };
  std::vector<Verdict> verdicts;  // of a frame that is wanted
};

/// Renders frames of the records, some of them ahead of the one that is asked for, each on a thread
/// of its own.
class RenderPass::FrameRenderer {
 public:
  FrameRenderer(const std::vector<RenderInput>& inputs, std::vector<RenderSurface>& surfaces,
                const Options& options)
      : inputs_(inputs),
        surfaces_(surfaces),
        untangler_(surfaces),
        wanted_(options.frames),
        threads_(std::max(options.threads, 1)),
        clock_(options.clock),
        held_(surfaces.size()) {
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      shapes_.emplace_back(*inputs[s].record, surfaces[s], half_of_change(options.fps));
      const Shot& shot = *inputs[s].shot;
      const double side = longer_side(shot.pattern);
      judges_.emplace_back(
          surfaces[s].mesh().pattern / side, surfaces[s].mesh().triangles, side,
          shot.colliders ? std::make_shared<const JudgedColliders>(*shot.colliders) : nullptr);
      std::vector<int>& vertices = vertex_of_handle_.emplace_back();
      for (const Handle& handle : shot.handles)
        vertices.push_back(judges_.back().vertex_at(handle.pattern));
    }
  }

  /// The k-th frame of the records; k grows from call to call.
  FrameOfSheets operator()(std::size_t k) {
    while (!pending_.empty() && pending_.front().k < k) pending_.pop_front();  // waits for it
    for (next_ = std::max(next_, k);
         next_ < frames_of_any(inputs_) && (pending_.size() < threads_ || next_ == k); ++next_)
      if (is_needed(next_) && !start(next_)) break;
    FrameOfSheets rendered = pending_.front().rendered.get();
    if (pending_.front().repeated)
      for (FrameOfSheets::Verdict& verdict : rendered.verdicts) verdict.statistics.ms = 0;
    pending_.pop_front();
    return rendered;
  }

 private:
  struct PendingFrame {
    std::size_t k;
    std::shared_future<FrameOfSheets> rendered;
    bool repeated = false;  // it is the frame before, which rests
  };

  /// The k-th frame is the one before to the last bit, in all that its rendering depends on.
  bool rests(std::size_t k) const {
    if (!simulated_alike(inputs_, k)) return false;
    const auto& frames = inputs_.front().record->frames();
    if (wanted_.contains(frames[k].frame) && !wanted_.contains(frames[k - 1].frame)) return false;
    for (std::size_t s = 0; s < sheets_with_frame(inputs_, k); ++s) {
      const std::vector<RecordedFrame>& recorded = inputs_[s].record->frames();
      const RecordedFrame &now = recorded[k], &before = recorded[k - 1];
      if (now.held != before.held || now.held_at != before.held_at || now.keyed != before.keyed)
        return false;
      if (const auto& colliders = inputs_[s].shot->colliders) {
        const int row = now.frame - recorded.front().frame;
        const ColliderMotion motion = motion_to(*colliders, row);
        if (farthest_move(motion.from, motion.to) > 0) return false;
      }
    }
    return true;
  }

  /// The frame is wanted, or one beside it, whose velocity depends on it.
  bool is_needed(std::size_t k) const {
    const auto& frames = inputs_.front().record->frames();
    const auto wanted = [&](std::size_t i) {
      return i < frames.size() && wanted_.contains(frames[i].frame);
    };
    return wanted(k) || wanted(k + 1) || wanted(k - 1);
  }

  /// False while frames are pending in which other handles hold the sheet.
  bool start(std::size_t k) {
    if (last_ && last_->k + 1 == k && rests(k)) {
      last_ = PendingFrame{k, last_->rendered, true};
      pending_.push_back(*last_);
      return true;
    }
    std::vector<ShapeCache::Sum> shapes;
    for (std::size_t s = 0; s < sheets_with_frame(inputs_, k); ++s) {
      const RecordedFrame& recorded = inputs_[s].record->frames()[k];
      if (held_[s] != recorded.held) {
        if (!pending_.empty()) return false;
        surfaces_[s].hold(recorded.held);  // expensive, but rare: it counts for no frame's time
        held_[s] = recorded.held;
      }
    }
    for (std::size_t s = 0; s < sheets_with_frame(inputs_, k); ++s)
      shapes.push_back(shapes_[s].at(k));
    last_ =
        PendingFrame{k, std::async(launch_policy(static_cast<int>(threads_)), [this, k, shapes] {
                          return render(k, shapes);
                        }).share()};
    pending_.push_back(*last_);
    return true;
  }

  FrameOfSheets render(std::size_t k, const std::vector<ShapeCache::Sum>& shapes) const {
    const StageClock::Part part(clock_, Stage::render_frames);
    FrameOfSheets rendered;
    std::vector<SheetUntangler::Simulated> simulated;
    std::vector<double> ms;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      const double start_ms = cpu_ms();
      const RecordedFrame& recorded = inputs_[s].record->frames()[k];
      simulated.push_back({inputs_[s].record->sheet(recorded), &shapes[s].places()});
      rendered.frames.push_back(surfaces_[s].frame(simulated[s].sheet, *simulated[s].places,
                                                   shapes[s](), recorded.held_at));
      ms.push_back(cpu_ms() - start_ms);
    }
    const double start_ms = cpu_ms();
    if (rendered.frames.size() == surfaces_.size()) {
      const StageClock::Part keeping_apart(clock_, Stage::keep_apart);
      untangler_.keep_apart(rendered.frames, simulated);
    }
    const double each_ms = (cpu_ms() - start_ms) / std::max<std::size_t>(1, shapes.size());
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      const double start_ms = cpu_ms();
      if (push_out_of_colliders(s, k, simulated[s], rendered.frames[s].x))
        surfaces_[s].shade(rendered.frames[s]);
      ms[s] += each_ms + cpu_ms() - start_ms;
    }
    if (wanted_.contains(inputs_.front().record->frames()[k].frame))
      rendered.verdicts = judge(k, rendered.frames, ms);
    return rendered;
  }

  /// The curved surface stands out from its facets: where they rest on a collider, into it.
  /// returns  whether x was changed
  bool push_out_of_colliders(std::size_t s, std::size_t k,
                             const SheetUntangler::Simulated& simulated, Points3& x) const {
    const StageClock::Part part(clock_, Stage::keep_apart);
    const auto& colliders = inputs_[s].shot->colliders;
    if (!colliders) return false;
    const auto& frames = inputs_[s].record->frames();
    Points3 on_facets = x;  // vertices of a finer mesh, in the middle of edges, are near enough
    for (std::size_t v = 0; v < simulated.places->size(); ++v)
      on_facets.row(v) =
          interpolate((*simulated.places)[v], simulated.sheet.triangles, simulated.sheet.x);
    const ColliderShapes shapes = shapes_at(*colliders, frames[k].frame - frames.front().frame);
    // a sheet that is jammed has stayed behind in the collider: pushed out, it would be torn
    Points3 outside = on_facets;
    if (push_out(shapes, on_facets, 0, outside) > yield_depth) return false;
    const std::vector<char>& held = surfaces_[s].is_held();
    // vertices first, then edges and triangles: a corner of the collider stands between vertices
    std::optional<ColliderClearance> clearance;
    if (may_touch(shapes, x))
      clearance.emplace(colliders, shapes, surfaces_[s].mesh().triangles, on_facets);
    // lengths that are wrong after this are restored, as far as the sheet stays outside
    constexpr int max_turns = 8;
    constexpr double still = 1e-6;  // [m] what is pushed by less needs no other turn
    for (int turn = 0;; ++turn) {
      const Points3 before = x;
      double pushed = push_out(shapes, on_facets, 0, x);
      for (int v = 0; v < x.rows(); ++v)
        if (held[v]) x.row(v) = before.row(v);
      if (clearance) pushed = std::max(pushed, clearance->push_out(held, x));
      if (pushed < still || turn == max_turns) return turn > 0 || pushed > 0;
      surfaces_[s].limit_strain(x);
    }
  }

  /// ms  of each sheet
  std::vector<FrameOfSheets::Verdict> judge(std::size_t k, const std::vector<RenderFrame>& frames,
                                            const std::vector<double>& ms) const {
    const StageClock::Part part(clock_, Stage::judge);
    std::vector<FrameOfSheets::Verdict> verdicts;
    std::vector<Points3> stored_x;
    for (std::size_t s = 0; s < frames.size(); ++s) {
      const std::vector<RecordedFrame>& recorded = inputs_[s].record->frames();
      const Points3& x = stored_x.emplace_back(as_stored(frames[s].x));
      FrameOfSheets::Verdict& verdict = verdicts.emplace_back();
      const RenderFrame::Counted& counted = frames[s].counted;
      verdict.judgement =
          judges_[s](x, recorded[k].frame - recorded.front().frame,
                     counted.x == x ? std::optional(counted.crossings) : std::nullopt);
      verdict.handle_error = handle_error(s, recorded[k], x);
      verdict.statistics = statistics_of(verdict.judgement, judges_[s]);
      verdict.statistics.ms = ms[s];
      verdict.statistics.kept_apart = frames[s].kept_apart;
    }
    const std::vector<int> with_others = untangler_.crossings(stored_x);
    for (std::size_t s = 0; s < frames.size(); ++s)
      verdicts[s].statistics.crossings_with_others = with_others[s];
    return verdicts;
  }

  double handle_error(std::size_t s, const RecordedFrame& recorded, const Points3& x) const {
    double most = 0;
    for (std::size_t h = 0; h < recorded.held.size(); ++h) {
      if (inputs_[s].shot->handles[recorded.held[h]].stiffness > 0) continue;  // meant to lag
      const int vertex = vertex_of_handle_[s][recorded.held[h]];
      most = std::max(most, (x.row(vertex) - recorded.keyed.row(h)).norm());
    }
    return most;
  }

  const std::vector<RenderInput>& inputs_;
  std::vector<RenderSurface>& surfaces_;
  const SheetUntangler untangler_;
  std::vector<CacheJudge> judges_;
  std::vector<std::vector<int>> vertex_of_handle_;  // of each sheet, on its render mesh
  const FrameSpan& wanted_;
  const std::size_t threads_;
  StageClock* const clock_;
  std::vector<std::optional<std::vector<int>>> held_;
  std::vector<ShapeCache> shapes_;
  std::size_t next_ = 0;              // the first that was not started
  std::deque<PendingFrame> pending_;  // in order
  std::optional<PendingFrame> last_;  // that was started
};

struct RenderPass::State {
  State(std::vector<RenderInput> sheets, const Options& with)
      : inputs(std::move(sheets)),
        options(with),
        surfaces(make_surfaces()),
        renderer(inputs, surfaces, options),
        rendered(inputs.size()) {
    for (std::size_t s = 0; s < inputs.size(); ++s) {
      rendered[s].mesh.triangles = surfaces[s].mesh().triangles;
      rendered[s].mesh.normal_of_corner = surfaces[s].normal_of_corner();
      rendered[s].mesh.uv = surfaces[s].mesh().pattern / longer_side(inputs[s].shot->pattern);
      if (const auto& authored = inputs[s].shot->authored)
        rendered[s].mesh.surface = std::make_shared<const MeshSurface>(
            surface_on(*authored, surfaces[s].mesh().pattern, surfaces[s].mesh().triangles));
    }
  }

  std::vector<RenderSurface> make_surfaces() const;
  // for each sheet, triangles of its simulated meshes
  using FacetsOfSheets = std::vector<std::set<ShotRecord::Facet>>;
  FacetsOfSheets intersecting_facets(const std::vector<RenderSurface>&) const;
  Points3 velocity(std::size_t sheet) const;
  bool next();

  std::vector<RenderInput> inputs;
  Options options;
  std::vector<RenderSurface> surfaces;
  FrameRenderer renderer;
  std::optional<FrameOfSheets> before, now, after;
  std::size_t k = 0;  // of the frame in the records that comes next
  std::vector<RenderedSheet> rendered;
};

/// The facets of all frames that intersect each other, however flat the render meshes are made,
/// because these cut off the folds of layers that are near each other.
RenderPass::State::FacetsOfSheets RenderPass::State::intersecting_facets(
    const std::vector<RenderSurface>& sheets) const {
  const SheetUntangler untangler(sheets);
  std::vector<MeshPointCache> points;
  for (std::size_t s = 0; s < sheets.size(); ++s) points.emplace_back(*inputs[s].record, sheets[s]);
  const auto of_frame = [&](std::size_t k, const std::vector<MeshPoints>& at) {
    const StageClock::Part part(options.clock, Stage::render_mesh);
    FacetsOfSheets facets(sheets.size());
    std::vector<SheetUntangler::Simulated> simulated;
    const auto mesh = [&](std::size_t s) { return inputs[s].record->frames()[k].mesh; };
    for (std::size_t s = 0; s < at.size(); ++s) {
      // the vertices are located on the simulated mesh only where somebody asks for it
      const Sheet sheet = inputs[s].record->sheet(inputs[s].record->frames()[k]);
      if (sheets[s].may_have_intersecting_facets(sheet))
        for (const int t : sheets[s].intersecting_facets(sheet, at[s].get()))
          facets[s].insert({mesh(s), t});
      if (sheets.size() > 1) simulated.push_back({sheet, &at[s].get()});
    }
    if (simulated.size() == sheets.size() && untangler.linear_surfaces_intersect(simulated))
      for (std::size_t s = 0; s < at.size(); ++s)
        for (int t = 0; t < simulated[s].sheet.triangles.rows(); ++t)
          facets[s].insert({mesh(s), t});
    return facets;
  };
  const std::size_t threads = std::max(options.threads, 1), frames = frames_of_any(inputs);
  FacetsOfSheets found(sheets.size());
  std::deque<std::future<FacetsOfSheets>> pending;
  for (std::size_t k = 0; k < frames || !pending.empty(); ++k) {
    if (k < frames && simulated_alike(inputs, k)) continue;
    if (k < frames) {
      std::vector<MeshPoints> at;
      for (std::size_t s = 0; s < sheets.size() && k < inputs[s].record->frames().size(); ++s)
        at.push_back(points[s].at(k));
      for (std::size_t s = 0; s < at.size(); ++s) points[s].forget_before(k);
      pending.push_back(std::async(launch_policy(options.threads),
                                   [&of_frame, k, at] { return of_frame(k, at); }));
      if (pending.size() < threads) continue;
    }
    const FacetsOfSheets more = pending.front().get();
    pending.pop_front();
    for (std::size_t s = 0; s < found.size(); ++s) found[s].insert(more[s].begin(), more[s].end());
  }
  return found;
}

std::vector<RenderSurface> RenderPass::State::make_surfaces() const {
  const StageClock::Part part(options.clock, Stage::render_mesh);
  constexpr int max_rounds = 4;
  FacetsOfSheets exact(inputs.size());  // whose edges are among those of the render mesh
  std::vector<std::vector<CreaseSegment>> seam_lines(inputs.size());
  for (std::size_t s = 0; s < inputs.size(); ++s)
    if (const auto& authored = inputs[s].shot->authored;
        authored && options.features == Features::all)
      for (const auto& [a, b] : seams(*authored)) seam_lines[s].push_back({a, b});
  for (int round = 0;; ++round) {
    std::vector<RenderSurface> sheets;
    for (std::size_t s = 0; s < inputs.size(); ++s) {
      const Shot& shot = *inputs[s].shot;
      RenderFeatures features = inputs[s].record->features(shot);
      if (options.features == Features::handles) {
        features.points.resize(shot.handles.size());
        features.creases.clear();
      } else {
        features.edges = inputs[s].record->edges(exact[s]);
      }
      features.seams = seam_lines[s];
      sheets.push_back(
          make_render_surface(shot.pattern, features, inputs[s].record->edge(), options.quality));
    }
    if (round == max_rounds || options.features == Features::handles) return sheets;
    FacetsOfSheets wanted = exact;
    const FacetsOfSheets found = intersecting_facets(sheets);
    for (std::size_t s = 0; s < wanted.size(); ++s)
      wanted[s].insert(found[s].begin(), found[s].end());
    std::size_t more = 0;
    for (std::size_t s = 0; s < wanted.size(); ++s) more += wanted[s].size() - exact[s].size();
    if (more == 0) return sheets;
    exact = std::move(wanted);
  }
}

Points3 RenderPass::State::velocity(std::size_t s) const {
  const auto has = [&](const std::optional<FrameOfSheets>& other) {
    return other && s < other->frames.size();
  };
  const Points3& x = now->frames[s].x;
  if (has(before) && has(after))
    return 0.5 * options.fps * (after->frames[s].x - before->frames[s].x);
  if (has(after)) return options.fps * (after->frames[s].x - x);
  if (has(before)) return options.fps * (x - before->frames[s].x);
  return Points3::Zero(x.rows(), 3);
}

bool RenderPass::State::next() {
  const auto& recorded = inputs.front().record->frames();
  for (; k < recorded.size(); ++k) {
    before = std::move(now);
    now = std::move(after);
    after.reset();
    if (options.frames.contains(recorded[k].frame)) break;
  }
  if (k == recorded.size()) return false;
  if (k > 0 && !before) before = renderer(k - 1);
  if (!now) now = renderer(k);
  if (k + 1 < recorded.size()) after = renderer(k + 1);
  rendered.resize(now->frames.size());
  for (std::size_t s = 0; s < rendered.size(); ++s) {
    rendered[s].frame = recorded[k].frame;
    rendered[s].record_index = k;
    rendered[s].mesh.velocity = velocity(s);
    rendered[s].mesh.x = now->frames[s].x;
    rendered[s].mesh.normal = now->frames[s].normals;
    rendered[s].mesh.crease = now->frames[s].crease;
    rendered[s].statistics = now->verdicts[s].statistics;
    rendered[s].judgement = now->verdicts[s].judgement;
    rendered[s].handle_error = now->verdicts[s].handle_error;
  }
  ++k;
  return true;
}

RenderPass::RenderPass(std::vector<RenderInput> sheets, const Options& options)
    : state_(std::make_unique<State>(std::move(sheets), options)) {}

RenderPass::~RenderPass() = default;

bool RenderPass::next() { return state_->next(); }

std::vector<RenderedSheet>& RenderPass::sheets() { return state_->rendered; }

const Points2& RenderPass::pattern(std::size_t sheet) const {
  return state_->surfaces[sheet].mesh().pattern;
}

std::vector<std::vector<std::size_t>> groups_near_each_other(
    const std::vector<const ShotRecord*>& records) {
  std::vector<std::vector<Eigen::AlignedBox3f>> boxes(records.size());
  for (std::size_t s = 0; s < records.size(); ++s)
    for (const RecordedFrame& frame : records[s]->frames()) {
      // the curved surface stands out from its facets by less than half an edge
      const Eigen::Vector3f margin =
          Eigen::Vector3f::Constant(static_cast<float>(0.5 * records[s]->edge()));
      boxes[s].emplace_back(frame.x.colwise().minCoeff().transpose() - margin,
                            frame.x.colwise().maxCoeff().transpose() + margin);
    }
  const auto near = [&](std::size_t s, std::size_t t) {
    for (std::size_t k = 0; k < std::min(boxes[s].size(), boxes[t].size()); ++k)
      if (boxes[s][k].intersects(boxes[t][k])) return true;
    return false;
  };
  std::vector<std::size_t> group(records.size());  // named after its first sheet
  for (std::size_t s = 0; s < records.size(); ++s) {
    group[s] = s;
    for (std::size_t t = 0; t < s; ++t)
      if (const std::size_t a = std::min(group[s], group[t]), b = std::max(group[s], group[t]);
          a != b && near(s, t))
        std::replace(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(s) + 1, b, a);
  }
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t first = 0; first < records.size(); ++first) {
    std::vector<std::size_t> sheets;
    for (std::size_t s = 0; s < records.size(); ++s)
      if (group[s] == first) sheets.push_back(s);
    if (!sheets.empty()) groups.push_back(sheets);
  }
  return groups;
}

}  // namespace paperbake
