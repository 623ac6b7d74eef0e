#include "core/animation/animate.h"

#include "core/animation/cpu_clock.h"
#include "core/animation/sheet_islands.h"
#include "core/animation/sheet_simulation.h"
#include "core/model/error.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

using Party = SheetsBeside::Party;

/// CPU time that one frame takes for a sheet. [ms]
struct Times {
  double elastic = 0, geometry = 0;
};

/// Does the work and adds its CPU time to the sheets of an island, in equal shares.
void count(std::vector<Times>& times, double Times::*what, const Party& sheets,
           const std::function<void()>& work) {
  const double begun = cpu_ms();
  work();
  for (const std::size_t s : sheets) times[s].*what += (cpu_ms() - begun) / sheets.size();
}

/// The elastic step of a frame. Every island takes it by itself first; islands whose sheets would
/// have collided on the way are merged and take it again together.
/// returns  the islands in which the step was taken
std::vector<Party> step(SheetsBeside::Sheets& sheets, const SheetsBeside* beside,
                        std::vector<Times>& times) {
  std::vector<Party> parties;
  const auto go = [&](const Party& party) {
    count(times, &Times::elastic, party, [&] {
      if (party.size() == 1) {
        Animation& alone = *sheets[party.front()];
        if (alone.stays())
          alone.stay();
        else
          alone.step(beside ? Animation::Trace::kept : Animation::Trace::none);
      } else
        beside->step(party);
    });
  };
  if (!beside) {
    for (std::size_t s = 0; s < sheets.size(); ++s) go(parties.emplace_back(Party{s}));
    return parties;
  }
  Party all;
  for (std::size_t s = 0; s < sheets.size(); ++s) all.push_back(s);
  count(times, &Times::elastic, all, [&] { parties = beside->within_reach(); });
  for (const Party& party : parties) go(party);
  for (;;) {
    std::vector<Party> joined;
    count(times, &Times::elastic, all, [&] { joined = beside->where_ways_meet(parties); });
    if (joined.size() == parties.size()) return parties;
    for (const Party& party : joined)
      if (std::find(parties.begin(), parties.end(), party) == parties.end()) go(party);
    parties = std::move(joined);
  }
}

}  // namespace

void animate_together(const std::vector<AnimatedSheet>& all,
                      const std::function<bool(const AnimatedFrame&)>& on_frame) {
  const AnimateOptions& options = all.front().options;
  SheetsBeside::Sheets sheets;
  std::vector<Times> times(all.size());
  for (const AnimatedSheet& one : all)
    count(times, &Times::geometry, {sheets.size()}, [&] {
      sheets.push_back(
          std::make_unique<Animation>(one.shot, one.method, one.options, sheets.size()));
    });
  for (const auto& sheet : sheets)
    if (sheet->next_frame() != sheets.front()->next_frame())
      throw Error(Fault::scene, "state", "Sheets that are animated together go on from one frame.");
  const bool begins = options.go_on_from.empty();
  if (!begins) times.assign(all.size(), {});
  std::optional<SheetsBeside> beside;
  if (all.size() > 1 && options.elastic.contact == SelfContact::automatic)
    beside.emplace(sheets, begins ? SheetsBeside::Begin::anew : SheetsBeside::Begin::as_kept);

  for (int frame = sheets.front()->next_frame(); frame <= options.last_frame; ++frame) {
    const auto fits = [&](std::size_t s) -> Animation::Fits {
      return [&, s](const Sheet& here, const Sheet& there, double moved) {
        return !beside || beside->fits(s, here, there, moved);
      };
    };
    for (std::size_t s = 0; s < sheets.size(); ++s)
      count(times, &Times::geometry, {s}, [&] { sheets[s]->prepare(fits(s)); });
    const std::vector<Party> parties = step(sheets, beside ? &*beside : nullptr, times);
    for (std::size_t s = 0; s < sheets.size(); ++s)
      count(times, &Times::elastic, {s}, [&] { sheets[s]->settle(fits(s)); });
    for (const Party& party : parties)
      count(times, &Times::geometry, party, [&] {
        if (party.size() > 1)
          beside->show(party);
        else
          sheets[party.front()]->show(Animation::Shown::as_finished);
      });
    if (beside) beside->part();
    std::vector<AnimatedFrame> results;
    for (std::size_t s = 0; s < sheets.size(); ++s) {
      results.push_back(sheets[s]->report());
      results.back().elastic_ms = times[s].elastic;
      results.back().geometry_ms = times[s].geometry;
    }
    times.assign(all.size(), {});
    for (const AnimatedFrame& result : results)
      if (!on_frame(result)) return;
  }
}

void animate(const Shot& shot, const Method& method, const AnimateOptions& options,
             const std::function<bool(const AnimatedFrame&)>& on_frame) {
  animate_together({{shot, method, options}}, on_frame);
}

}  // namespace paperbake
