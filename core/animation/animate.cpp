#include "core/animation/animate.h"

#include "core/animation/cpu_clock.h"
#include "core/animation/rehearsal.h"
#include "core/animation/sheet_islands.h"
#include "core/animation/sheet_simulation.h"
#include "core/model/error.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

using Island = SheetIslands::Island;

/// CPU time that one frame takes for a sheet. [ms]
struct Times {
  double elastic = 0, geometry = 0;
};

/// Does the work and adds its CPU time to the sheets of an island, in equal shares.
void time_work(std::vector<Times>& times, double Times::*what, const Island& sheets,
               const std::function<void()>& work) {
  const double start_ms = cpu_ms();
  work();
  const double share = (cpu_ms() - start_ms) / sheets.size();
  for (const std::size_t s : sheets) times[s].*what += share;
}

/// The elastic step of a frame. Every island takes it by itself first; islands whose sheets would
/// have collided on the way are merged and take it again together.
/// returns  the islands in which the step was taken
std::vector<Island> step(SheetIslands::Sheets& sheets, const SheetIslands* between_sheets,
                         const std::function<AdmissibilityCheck(std::size_t)>& is_admissible,
                         std::vector<Times>& times) {
  std::vector<Island> islands;
  const auto step_island = [&](const Island& island) {
    time_work(times, &Times::elastic, island, [&] {
      if (island.size() == 1)
        sheets[island.front()]->step(between_sheets ? SheetSimulation::RecordTrajectory::yes
                                                    : SheetSimulation::RecordTrajectory::no,
                                     is_admissible(island.front()));
      else
        between_sheets->step(island);
    });
  };
  if (!between_sheets) {
    for (std::size_t s = 0; s < sheets.size(); ++s) step_island(islands.emplace_back(Island{s}));
    return islands;
  }
  Island all;
  for (std::size_t s = 0; s < sheets.size(); ++s) all.push_back(s);
  time_work(times, &Times::elastic, all, [&] { islands = between_sheets->build_islands(); });
  for (const Island& island : islands) step_island(island);
  for (;;) {
    std::vector<Island> joined;
    time_work(times, &Times::elastic, all,
              [&] { joined = between_sheets->merge_colliding(islands); });
    if (joined.size() == islands.size()) return islands;
    for (const Island& island : joined)
      if (std::find(islands.begin(), islands.end(), island) == islands.end()) step_island(island);
    islands = std::move(joined);
  }
}

}  // namespace

struct Animation::State {
  explicit State(const std::vector<AnimatedSheet>& sheets) : all(sheets), times(sheets.size()) {}

  const std::vector<AnimatedSheet> all;
  std::vector<Times> times;  // since the last frame
  SheetIslands::Sheets sheets;
  std::optional<SheetIslands> between_sheets;

  const AnimateOptions& options() const { return all.front().options; }
  AdmissibilityCheck is_admissible(std::size_t s) const {
    return [this, s](const Sheet& here, const Sheet& there, double moved) {
      return !between_sheets || between_sheets->is_admissible(s, here, there, moved);
    };
  }
};

Animation::Animation(const std::vector<AnimatedSheet>& all) : state_(std::make_unique<State>(all)) {
  State& a = *state_;
  for (const AnimatedSheet& one : all) {
    SheetSimulation::Place place{a.sheets.size(), {}};
    time_work(a.times, &Times::elastic, {place.number},
              [&] { place.rehearsal = rehearse(one.shot, one.method, one.options); });
    time_work(a.times, &Times::geometry, {place.number}, [&] {
      a.sheets.push_back(
          std::make_unique<SheetSimulation>(one.shot, one.method, one.options, place));
    });
  }
  for (const auto& sheet : a.sheets)
    if (sheet->next_frame() != a.sheets.front()->next_frame())
      throw Error(ErrorCode::scene, "state",
                  "Sheets that are animated together go on from one frame.");
  const bool begins = a.options().resume_state.empty();
  if (!begins) a.times.assign(all.size(), {});
  if (all.size() > 1 && a.options().elastic.contact == SelfContact::automatic)
    a.between_sheets.emplace(a.sheets,
                             begins ? SheetIslands::Start::fresh : SheetIslands::Start::resumed);
}

Animation::~Animation() = default;

bool Animation::is_over() const {
  return state_->sheets.front()->next_frame() > state_->options().last_frame;
}

std::vector<AnimatedFrame> Animation::next_frame() {
  SheetIslands::Sheets& sheets = state_->sheets;
  std::vector<Times>& times = state_->times;
  const SheetIslands* between = state_->between_sheets ? &*state_->between_sheets : nullptr;
  for (std::size_t s = 0; s < sheets.size(); ++s)
    time_work(times, &Times::geometry, {s}, [&] { sheets[s]->prepare(state_->is_admissible(s)); });
  const std::vector<Island> islands = step(
      sheets, between, [&](std::size_t s) { return state_->is_admissible(s); }, times);
  for (std::size_t s = 0; s < sheets.size(); ++s)
    time_work(times, &Times::elastic, {s},
              [&] { sheets[s]->finish_step(state_->is_admissible(s)); });
  for (const Island& island : islands)
    time_work(times, &Times::geometry, island, [&] {
      if (island.size() > 1)
        between->finalize(island);
      else
        sheets[island.front()]->finalize(SheetSimulation::Output::finished_sheet);
    });
  if (between) state_->between_sheets->restore_contact_distances();
  std::vector<AnimatedFrame> frames;
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    frames.push_back(sheets[s]->report());
    frames.back().statistics.elastic_ms = times[s].elastic;
    frames.back().statistics.geometry_ms = times[s].geometry;
  }
  times.assign(sheets.size(), {});
  return frames;
}

void animate_together(const std::vector<AnimatedSheet>& all,
                      const std::function<bool(const AnimatedFrame&)>& on_frame) {
  Animation animation(all);
  while (!animation.is_over())
    for (const AnimatedFrame& frame : animation.next_frame())
      if (!on_frame(frame)) return;
}

void animate(const Shot& shot, const MethodChoice& method, const AnimateOptions& options,
             const std::function<bool(const AnimatedFrame&)>& on_frame) {
  animate_together({{shot, method, options}}, on_frame);
}

}  // namespace paperbake
