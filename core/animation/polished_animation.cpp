#include "core/animation/polished_animation.h"

#include "core/animation/cpu_clock.h"
#include "core/animation/initial_sheet.h"
#include "core/animation/polisher.h"
#include "core/geometry/judged_colliders.h"
#include "core/geometry/measure.h"
#include "core/model/error.h"
#include "core/model/pattern.h"
#include "core/render/shot_record.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

/// A frame as the method left it.
struct CoarseFrame {
  // frame.sheet points to `sheet` once this object has its final place
  AnimatedFrame frame;
  Sheet sheet;
  std::shared_ptr<const PlasticGrid> plastic_grid;  // null: elastic paper
};

struct RefinementResult {
  std::optional<Polished> polished;  // none: it was not tried
  std::string rejection;             // why it is not handed on; empty: it is
  double ms = 0;
};

class PolishedShot {
 public:
  PolishedShot(const Shot& shot, const AnimateOptions& animation, const PolishOptions& options)
      : shot_(shot),
        animation_(animation),
        options_(options),
        regripped_(shot.handles.size(), Vector3d::Zero()) {
    if (shot.colliders) colliders_.emplace(*shot.colliders);
  }

  void add(const AnimatedFrame& frame) {
    record_.add(frame);
    CoarseFrame rough{frame, *frame.sheet, {}};
    rough.frame.state = nullptr;  // of a simulation that has gone on when this frame is handed on
    if (frame.plastic_grid) {
      const bool as_before =
          !frames_.empty() && frames_.back().frame.statistics.plastic == frame.statistics.plastic;
      rough.plastic_grid = as_before ? frames_.back().plastic_grid
                                     : std::make_shared<const PlasticGrid>(*frame.plastic_grid);
    }
    frames_.push_back(std::move(rough));
  }

  /// returns  false when on_frame did
  bool hand_on(const std::function<bool(const AnimatedFrame&)>& on_frame) {
    if (frames_.empty()) return true;
    for (int t = 0; t < std::max(1, options_.threads); ++t)
      polishers_.emplace_back(shot_, animation_.elastic, options_.triangles,
                              record_.features(shot_));
    rebind_relative_handles();
    if (!worth_while()) return hand_on_as_they_are(on_frame);
    const std::size_t at_once = 4 * std::max(1, options_.threads);
    for (std::size_t begin = 0; begin < frames_.size(); begin += at_once) {
      const std::size_t end = std::min(frames_.size(), begin + at_once);
      std::vector<std::size_t> chunk;
      for (std::size_t k = begin; k < end; ++k)
        if (wanted(frames_[k])) chunk.push_back(k);
      const std::vector<RefinementResult> results = polish(chunk);
      std::size_t next = 0;
      for (std::size_t k = begin; k < end; ++k)
        if (!show(frames_[k], wanted(frames_[k]) ? results[next++] : RefinementResult{}, on_frame))
          return false;
    }
    return true;
  }

 private:
  /// A polished crumple ends in another crumple or in no equilibrium at all, and a mixture of
  /// polished and unpolished frames would flicker. So eight frames of the shot are tried first, and
  /// the shot is polished if half of them are accepted.
  bool worth_while() {
    constexpr std::size_t samples = 8;
    std::vector<std::size_t> tried;
    for (std::size_t s = 0; s < samples; ++s)
      if (const std::size_t k = (2 * s + 1) * frames_.size() / (2 * samples);
          tried.empty() || tried.back() != k)
        tried.push_back(k);
    const std::vector<RefinementResult> results = polish(tried);
    const auto fit = std::count_if(results.begin(), results.end(),
                                   [](const RefinementResult& a) { return a.rejection.empty(); });
    return 2 * static_cast<std::size_t>(fit) >= tried.size();
  }

  bool hand_on_as_they_are(const std::function<bool(const AnimatedFrame&)>& on_frame) {
    RefinementResult none;
    none.rejection = "most frames of this shot have no minimum near by";
    for (CoarseFrame& rough : frames_)
      if (!show(rough, none, on_frame)) return false;
    return true;
  }

  const InitialSheet& mesh() const { return polishers_.front().mesh(); }

  /// A relative handle takes hold of the sheet where it is, and so of the polished sheet where that
  /// is.
  void rebind_relative_handles() {
    for (const CoarseFrame& rough : frames_) {
      std::vector<std::size_t> taking_hold;
      for (std::size_t h = 0; h < shot_.handles.size(); ++h)
        if (takes_hold(rough, h)) taking_hold.push_back(h);
      if (taking_hold.empty()) continue;
      const RefinementResult found = refine(rough, polishers_.front());
      if (!found.rejection.empty()) continue;
      for (const std::size_t h : taking_hold)
        regripped_[h] = found.polished->sheet.x.row(mesh().handle_vertex[h]).transpose() -
                        rough.frame.handles[h].at;
    }
  }

  /// True in the frame in which a relative handle takes hold; that frame was simulated without it.
  bool takes_hold(const CoarseFrame& rough, std::size_t h) const {
    const Handle& handle = shot_.handles[h];
    const int first = std::max(handle.grab_frame, animation_.first_frame);
    return handle.mode == HandleMode::relative && rough.frame.frame == first &&
           rough.frame.handles[h].state != HandleFrame::free;
  }

  bool wanted(const CoarseFrame& rough) const {
    return !options_.wanted || options_.wanted(rough.frame.frame);
  }

  /// Polishes these frames in parallel.
  /// returns  a result for each of them
  std::vector<RefinementResult> polish(const std::vector<std::size_t>& frames) {
    std::vector<RefinementResult> results(frames.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&](Polisher& polish) {
      for (std::size_t k = next++; k < frames.size(); k = next++)
        results[k] = refine(frames_[frames[k]], polish);
    };
    // what another thread throws comes out here, after all are finished
    std::vector<std::future<void>> others;
    for (std::size_t t = 1; t < polishers_.size(); ++t)
      others.push_back(std::async(std::launch::async, work, std::ref(polishers_[t])));
    work(polishers_.front());
    for (std::future<void>& other : others) other.get();
    return results;
  }

  RefinementResult refine(const CoarseFrame& rough, Polisher& polish) const {
    constexpr double elsewhere = 0.1;             // [1] of the longer side
    constexpr double max_trusted_stretch = 0.01;  // [1] |l - L|/L of an edge
    RefinementResult result;
    if (rough.frame.statistics.touching > 0) {
      result.rejection = "the sheet touches itself";
      return result;
    }
    if (rough.frame.statistics.touching_others > 0) {
      result.rejection = "the sheet touches another";
      return result;
    }
    if (rough.frame.statistics.inertia) {
      result.rejection = "the sheet moves with inertia";
      return result;
    }
    if (rough.frame.statistics.on_colliders > 0) {  // which the fine mesh does not feel
      result.rejection = "the sheet lies on a collider";
      return result;
    }
    const double start_ms = cpu_ms();
    std::vector<HeldHandle> held;
    for (std::size_t h = 0; h < rough.frame.handles.size(); ++h) {
      const HandleFrame& handle = rough.frame.handles[h];
      if (handle.state == HandleFrame::free || takes_hold(rough, h)) continue;
      held.push_back({static_cast<int>(h), handle.at + regripped_[h]});
    }
    try {
      result.polished = polish(rough.sheet, held, rough.plastic_grid.get());
      if (result.polished->near_itself)
        result.rejection = "parts of the sheet come near each other";
      else if (!result.polished->converged)
        result.rejection = "it does not come to rest";
      else if (result.polished->moved > elsewhere * longer_side(shot_.pattern) ||
               worst_edge(result.polished->sheet).error > max_trusted_stretch)
        result.rejection = "it ends somewhere else";
      else if (ends_deeper(rough, result.polished->sheet))  // which the fine mesh does not feel
        result.rejection = "it ends inside a collider";
    } catch (const Error& error) {
      result.rejection = error.cause;
    }
    result.ms = cpu_ms() - start_ms;
    return result;
  }

  /// Whether a polished sheet lies in a collider, deeper than before.
  bool ends_deeper(const CoarseFrame& rough, const Sheet& polished) const {
    if (!colliders_) return false;
    const int row = rough.frame.frame - animation_.first_frame;
    const double depth = colliders_->deepest(row, polished.x, polished.triangles).depth;
    return depth > depth_exact_to &&
           depth > colliders_->deepest(row, rough.sheet.x, rough.sheet.triangles).depth +
                       depth_exact_to;
  }

  bool show(CoarseFrame& rough, const RefinementResult& refined,
            const std::function<bool(const AnimatedFrame&)>& on_frame) const {
    AnimatedFrame& frame = rough.frame;
    frame.sheet = &rough.sheet;
    frame.plastic_grid = rough.plastic_grid.get();
    frame.statistics.elastic_ms += refined.ms;
    if (!refined.rejection.empty()) append_note(frame.note, "not polished: " + refined.rejection);
    if (!refined.polished || !refined.rejection.empty()) return on_frame(frame);
    const Polished& polished = *refined.polished;
    frame.sheet = &polished.sheet;
    frame.carried.resize(0, 3);
    frame.statistics.newton_iterations += polished.iterations;
    frame.statistics.energy = polished.energy;
    frame.statistics.membrane_energy = polished.membrane_energy;
    frame.statistics.converged = true;
    frame.parts.region.clear();  // the regions belong to the mesh of the method
    for (std::size_t h = 0; h < frame.handles.size(); ++h) {
      HandleFrame& handle = frame.handles[h];
      if (handle.state != HandleFrame::free) handle.keyed += regripped_[h];
      handle.at = polished.sheet.x.row(mesh().handle_vertex[h]);
    }
    if (animation_.report_plastic_curvature && rough.plastic_grid)
      frame.plastic_curvature =
          rough.plastic_grid->at_vertices(polished.sheet.pattern, polished.sheet.triangles);
    return on_frame(frame);
  }

  const Shot& shot_;
  const AnimateOptions& animation_;
  const PolishOptions& options_;
  std::vector<CoarseFrame> frames_;
  ShotRecord record_;
  std::vector<Polisher> polishers_;  // one for each thread, all alike
  // [m] of each handle: displacement from where it took hold of the unpolished sheet to where it
  // takes hold of the polished one
  std::vector<Vector3d> regripped_;
  std::optional<JudgedColliders> colliders_;  // none: the scene has none
};

}  // namespace

void animate_polished(const std::vector<AnimatedSheet>& sheets, const PolishOptions& options,
                      const std::function<bool(const AnimatedFrame&)>& on_frame) {
  std::vector<PolishedShot> polished;
  for (const AnimatedSheet& sheet : sheets)
    polished.emplace_back(sheet.shot, sheet.options, options);
  std::optional<Error> failure;
  bool ended = false;
  try {
    animate_together(sheets, [&](const AnimatedFrame& frame) {
      polished[frame.sheet_index].add(frame);
      ended = options.on_simulated && !options.on_simulated(frame);
      return !ended;
    });
  } catch (const Error& error) {
    failure = error;
  }
  if (ended) return;
  for (PolishedShot& shot : polished)
    if (!shot.hand_on(on_frame)) break;
  if (failure) throw *failure;
}

void animate_polished(const Shot& shot, const MethodChoice& method, const AnimateOptions& animation,
                      const PolishOptions& options,
                      const std::function<bool(const AnimatedFrame&)>& on_frame) {
  animate_polished({{shot, method, animation}}, options, on_frame);
}

}  // namespace paperbake
