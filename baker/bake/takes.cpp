#include "baker/bake/takes.h"

#include "baker/output/checkpoints.h"
#include "baker/output/gates.h"
#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

constexpr double hopeless_pct = 10;  // of the longer side: what is off by more never ends well
constexpr unsigned seed_step = 1000;
constexpr int finer = 4;  // times as many triangles

/// How far a handle may be off before other takes are tried: as far as the bake lets it be. [m]
constexpr double tolerance = 1e-3 * Gates{}.handle_err_mm;

/// Every second take has a finer first mesh.
bool is_finer(std::size_t take) { return take % 2 == 1; }

/// By how much the paper between a handle and another one is too short: a handle may be off by so
/// much whatever the take. [m]
double unavoidable(const BakePlan& plan, std::size_t sheet, const std::string& handle) {
  double most = 0;
  for (const UnreachablePairOfSheet& i : plan.impossible)
    if (i.sheet == plan.shots[sheet].sheet_name && (i.pair.a == handle || i.pair.b == handle))
      most = std::max(most, i.pair.apart - i.pair.allowed);
  return most;
}

/// A take that is being simulated.
class Candidate {
 public:
  Candidate(BakePlan plan, TriedTake known, StopRequest& stop)
      : plan_(std::move(plan)), options_(options_of_sheets(plan_)), take_(known) {
    for (AnimateOptions& of_sheet : options_)
      of_sheet.asks_to_stop = [&stop] { return stop.is_made(); };
  }

  const TriedTake& take() const { return take_; }
  bool has_begun() const { return animation_.has_value() || failed_; }
  bool is_over() const { return animation_ && animation_->is_over(); }
  /// What takes are compared by: all that are within the tolerance are alike.
  double badness() const {
    return failed_ ? std::numeric_limits<double>::infinity() : std::max(take_.off, tolerance);
  }
  bool is_hopeless() const { return failed_ || take_.off_pct >= hopeless_pct; }

  /// Simulates the next frame.
  void go_on() {
    try {
      if (!animation_) begin();
      for (const AnimatedFrame& frame : animation_->next_frame()) add_frame(take_, frame, plan_);
      take_.frames = std::max(take_.frames, ++simulated_);
    } catch (const Error& error) {
      // whoever stops it knows; anything else the bake itself says, if no take is better
      failed_ = error.code != ErrorCode::stopped;
    }
  }

 private:
  void begin() {
    std::vector<AnimatedSheet> sheets;
    for (std::size_t s = 0; s < plan_.shots.size(); ++s)
      sheets.push_back({plan_.shots[s], plan_.methods[s], options_[s]});
    animation_.emplace(sheets);
  }

  BakePlan plan_;
  std::vector<AnimateOptions> options_;
  TriedTake take_;
  std::optional<Animation> animation_;
  int simulated_ = 0;  // frames
  bool failed_ = false;
};

}  // namespace

void add_frame(TriedTake& take, const AnimatedFrame& frame, const BakePlan& plan) {
  const Shot& shot = plan.shots[frame.sheet_index];
  const double side = longer_side(shot.pattern);
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const HandleFrame& handle = frame.handles[h];
    const double off = handle.error() - unavoidable(plan, frame.sheet_index, shot.handles[h].name);
    take.off_pct = std::max(take.off_pct, 100 * off / side);
    if (off <= take.off) continue;
    take.off = off;
    take.frame = frame.frame;
  }
}

Takes::Takes(const BakeSettings& settings, const BakePlan& plan, std::filesystem::path decision)
    : settings_(settings),
      first_(plan),
      plan_(plan),
      decision_(std::move(decision)),
      key_(fmt::format("{} {} {}", program_key(), plan.simulation_hash, plan.animation.last_frame)),
      seen_(describe_take(0)),
      watches_(settings.takes > 1 && is_hybrid(settings)) {
  if (watches_ && settings.resume == Resume::automatic) watches_ = !load_choice();
}

void Takes::watch(const AnimatedFrame& frame) {
  if (!watches_ || failing_) return;
  add_frame(seen_, frame, first_);
  seen_.frames = frame.frame - first_.animation.first_frame + 1;
  failing_ = seen_.off > tolerance;
}

TriedTake Takes::describe_take(std::size_t number) const {
  const bool may_be_finer = !settings_.triangles && !settings_.accuracy && !settings_.budget &&
                            settings_.given.count("base_triangles") == 0;
  TriedTake take;
  take.seed_offset = seed_step * static_cast<unsigned>(number);
  take.base_triangles = settings_.base_triangles * (may_be_finer && is_finer(number) ? finer : 1);
  return take;
}

BakePlan Takes::plan_of(std::size_t number) const {
  BakePlan plan = first_;
  if (number == 0) return plan;
  const TriedTake take = describe_take(number);
  BakeSettings settings = settings_;
  settings.base_triangles = take.base_triangles;
  const auto with_take = [&](std::string& hash) {
    hash = hex(content_hash(fmt::format("{} take {}", hash, number)));
  };
  for (std::size_t s = 0; s < plan.shots.size(); ++s) {
    plan.seeds[s] += take.seed_offset;
    plan.methods[s] = make_method(settings, plan.shots[s], plan.seeds[s], s);
    with_take(plan.start_hash[s]);
  }
  with_take(plan.simulation_hash);
  return plan;
}

bool Takes::choose(Progress& progress, StopRequest& stop) {
  std::vector<std::unique_ptr<Candidate>> all;
  for (std::size_t k = 0; k < static_cast<std::size_t>(settings_.takes); ++k) {
    BakePlan plan = plan_of(k);
    plan.polish = {};
    all.push_back(
        std::make_unique<Candidate>(std::move(plan), k == 0 ? seen_ : describe_take(k), stop));
  }
  const auto best = [&] {
    return std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a->badness() < b->badness();
    });
  };
  for (auto next = best(); !(*next)->is_over() && !(*next)->is_hopeless(); next = best()) {
    if (stop.is_made()) return false;
    if (next != all.begin() && !(*next)->has_begun())
      progress.message(
          fmt::format("take {} of {} is tried, because in the take before it a handle "
                      "is off by {:.1f} mm",
                      next - all.begin() + 1, all.size(), 1e3 * (*(next - 1))->take().off));
    (*next)->go_on();
  }
  TakeChoice choice;
  choice.baked = (*best())->is_over() ? static_cast<std::size_t>(best() - all.begin()) : 0;
  for (const auto& candidate : all)
    if (candidate->take().frames > 0) choice.tried.push_back(candidate->take());
  keep_choice(choice);
  progress.message(describe(choice));
  adopt(std::move(choice));
  return true;
}

void Takes::adopt(TakeChoice choice) {
  plan_ = plan_of(choice.baked);
  plan_.take = std::move(choice);
  watches_ = failing_ = false;
}

void Takes::keep_choice(const TakeChoice& choice) const {
  Json tried = Json::array();
  for (const TriedTake& t : choice.tried) tried.push_back({t.off, t.off_pct, t.frame, t.frames});
  write_atomically(decision_,
                   json_line({{"key", key_}, {"baked", choice.baked}, {"tried", tried}}));
}

bool Takes::load_choice() {
  TakeChoice choice;
  try {
    const Json kept = parse_json(read_file(decision_).value_or(""));
    if (kept.at("key") != key_) return false;
    choice.baked = kept.at("baked");
    for (const Json& of_take : kept.at("tried")) {
      TriedTake take = describe_take(choice.tried.size());
      take.off = of_take.at(0);
      take.off_pct = of_take.at(1);
      take.frame = of_take.at(2);
      take.frames = of_take.at(3);
      choice.tried.push_back(take);
    }
  } catch (const std::exception&) {
    return false;  // there is none, or it is somebody else's
  }
  if (choice.baked >= choice.tried.size()) return false;
  adopt(std::move(choice));
  return true;
}

std::string describe(const TakeChoice& choice) {
  const TriedTake &first = choice.tried.front(), &baked = choice.tried.at(choice.baked);
  std::string text =
      fmt::format("takes: in the first take a handle is off by {:.1f} mm in frame {}",
                  1e3 * first.off, first.frame);
  const auto others = choice.tried.size() - 1;
  if (choice.baked == 0)
    return text + fmt::format("; it is baked, because {} {} not better", others,
                              others == 1 ? "other is" : "others are");
  text += fmt::format("; take {} of {} is baked, where handles are off by {:.2g} mm at most",
                      choice.baked + 1, choice.tried.size(), 1e3 * baked.off);
  if (baked.base_triangles != first.base_triangles)
    text += fmt::format(", on a first mesh of {} triangles", baked.base_triangles);
  return text;
}

}  // namespace paperbake
