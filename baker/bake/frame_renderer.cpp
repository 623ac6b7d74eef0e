#include "baker/bake/frame_renderer.h"

#include "baker/bake/push_out_of_colliders.h"
#include "baker/bake/task_queue.h"
#include "core/animation/cpu_clock.h"
#include "core/geometry/collider_motion.h"

#include <algorithm>
#include <memory>
#include <numeric>

namespace paperbake {
FrameRenderer::FrameRenderer(const std::vector<RenderInput>& inputs,
                             std::vector<RenderSurface>& surfaces, const RenderOptions& options)
    : inputs_(inputs),
      surfaces_(surfaces),
      untangler_(surfaces),
      wanted_(options.frames),
      threads_(std::max(options.threads, 1)),
      clock_(options.clock),
      held_(surfaces.size()) {
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    shapes_.emplace_back(*inputs[s].record, surfaces[s], options.fps);
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

FrameOfSheets FrameRenderer::operator()(std::size_t k) {
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

bool FrameRenderer::rests(std::size_t k) const {
  if (!simulated_alike(inputs_, k)) return false;
  const auto& frames = inputs_.front().record->frames();
  if (wanted_.contains(frames[k].frame) && !wanted_.contains(frames[k - 1].frame)) return false;
  for (std::size_t s = 0; s < sheets_with_frame(inputs_, k); ++s) {
    const std::vector<RecordedFrame>& recorded = inputs_[s].record->frames();
    const RecordedFrame &now = recorded[k], &before = recorded[k - 1];
    if (now.held != before.held || now.held_at != before.held_at || now.keyed != before.keyed ||
        now.folded.size() != before.folded.size())
      return false;
    if (const auto& colliders = inputs_[s].shot->colliders;
        colliders && farthest_move(*colliders, now.frame - recorded.front().frame) > 0)
      return false;
  }
  return true;
}

bool FrameRenderer::is_needed(std::size_t k) const {
  const auto& frames = inputs_.front().record->frames();
  const auto wanted = [&](std::size_t i) {
    return i < frames.size() && wanted_.contains(frames[i].frame);
  };
  return wanted(k) || wanted(k + 1) || wanted(k - 1);
}

bool FrameRenderer::start(std::size_t k) {
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
  last_ = PendingFrame{k, std::async(launch_policy(static_cast<int>(threads_)), [this, k, shapes] {
                            return render(k, shapes);
                          }).share()};
  pending_.push_back(*last_);
  return true;
}

FrameOfSheets FrameRenderer::render(std::size_t k,
                                    const std::vector<ShapeCache::Sum>& shapes) const {
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
  for (double& of_sheet : ms) of_sheet += each_ms;
  const bool among_colliders =
      std::any_of(inputs_.begin(), inputs_.end(),
                  [](const RenderInput& input) { return input.shot->colliders != nullptr; });
  if (among_colliders) clear_colliders(k, simulated, rendered.frames, ms);
  if (wanted_.contains(inputs_.front().record->frames()[k].frame))
    rendered.verdicts = judge(k, rendered.frames, ms);
  return rendered;
}

void FrameRenderer::clear_colliders(std::size_t k,
                                    const std::vector<SheetUntangler::Simulated>& simulated,
                                    std::vector<RenderFrame>& frames,
                                    std::vector<double>& ms) const {
  const StageClock::Part part(clock_, Stage::keep_apart);
  const std::vector<RenderFrame> before = frames;
  std::vector<char> changed(frames.size(), 0);
  const auto push_out = [&](std::size_t s, double clearance) {
    const double start_ms = cpu_ms();
    const Shot& shot = *inputs_[s].shot;
    const std::vector<RecordedFrame>& recorded = inputs_[s].record->frames();
    frames[s].x = before[s].x;
    changed[s] = push_out_of_colliders(
        {surfaces_[s], shot.colliders, recorded[k].frame - recorded.front().frame, simulated[s]},
        clearance, frames[s].x);
    if (changed[s]) count_crossings(s, frames[s]);
    ms[s] += cpu_ms() - start_ms;
  };
  // what is lifted by so much that it lies on a collider may meet the next layer or sheet: rather
  // than that it stays, with half its thickness inside
  for (std::size_t s = 0; s < frames.size(); ++s) {
    if (!inputs_[s].shot->colliders) continue;
    push_out(s, inputs_[s].shot->paper.thickness / 2);
    if (changed[s] && frames[s].counted.crossings > 0 &&
        frames[s].counted.crossings > surfaces_[s].crossings(as_stored(before[s].x)))
      push_out(s, 0);
  }
  if (std::find(changed.begin(), changed.end(), 1) == changed.end()) return;
  if (const int now = crossings_between_sheets(frames);
      now > 0 && now > crossings_between_sheets(before))
    for (std::size_t s = 0; s < frames.size(); ++s)
      if (changed[s]) push_out(s, 0);
  for (std::size_t s = 0; s < frames.size(); ++s)
    if (changed[s]) surfaces_[s].shade(frames[s]);
}

void FrameRenderer::count_crossings(std::size_t s, RenderFrame& frame) const {
  frame.counted.x = as_stored(frame.x);
  frame.counted.crossings = surfaces_[s].crossings(frame.counted.x);
}

int FrameRenderer::crossings_between_sheets(const std::vector<RenderFrame>& frames) const {
  if (frames.size() < 2) return 0;
  std::vector<Points3> stored;
  for (const RenderFrame& frame : frames) stored.push_back(as_stored(frame.x));
  const std::vector<int> counts = untangler_.crossings(stored);
  return std::accumulate(counts.begin(), counts.end(), 0);
}

std::vector<FrameOfSheets::Verdict> FrameRenderer::judge(std::size_t k,
                                                         const std::vector<RenderFrame>& frames,
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

double FrameRenderer::handle_error(std::size_t s, const RecordedFrame& recorded,
                                   const Points3& x) const {
  double most = 0;
  for (std::size_t h = 0; h < recorded.held.size(); ++h) {
    if (inputs_[s].shot->handles[recorded.held[h]].stiffness > 0) continue;  // meant to lag
    const int vertex = vertex_of_handle_[s][recorded.held[h]];
    most = std::max(most, (x.row(vertex) - recorded.keyed.row(h)).norm());
  }
  return most;
}

}  // namespace paperbake
