#include "baker/bake/attempts.h"

#include "baker/job/input_hash.h"
#include "baker/output/checkpoints.h"
#include "baker/output/gates.h"
#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

constexpr double hopeless_pct = 10;  // of the longer side: what is off by more never ends well
constexpr unsigned seed_step = 1000;

/// How far a handle may be off before other attempts are tried: as far as the bake lets it be. [m]
constexpr double tolerance = 1e-3 * Gates{}.handle_err_mm;

/// How many times as many triangles the first mesh of an attempt has. Sheets that lock on the mesh
/// of the first attempt do so less often on twice as fine a one, and some only on a still finer one
/// not at all.
int refinement(std::size_t attempt) {
  if (attempt == 0) return 1;
  return attempt % 2 == 1 ? 2 : 4;
}

/// By how much the paper between a handle and another one is too short: a handle may be off by so
/// much whatever the attempt. [m]
double unavoidable(const BakePlan& plan, std::size_t sheet, const std::string& handle) {
  double most = 0;
  for (const UnreachablePairOfSheet& i : plan.impossible)
    if (i.sheet == plan.shots[sheet].sheet_name && (i.pair.a == handle || i.pair.b == handle))
      most = std::max(most, i.pair.apart - i.pair.allowed);
  return most;
}

/// An attempt that is being simulated.
class Candidate {
 public:
  Candidate(BakePlan plan, Attempt known, StopRequest& stop)
      : plan_(std::move(plan)), options_(options_of_sheets(plan_)), attempt_(known) {
    for (AnimateOptions& of_sheet : options_)
      of_sheet.asks_to_stop = [&stop] { return stop.is_made(); };
  }

  const Attempt& attempt() const { return attempt_; }
  bool has_begun() const { return animation_.has_value() || failed_; }
  bool is_over() const { return animation_ && animation_->is_over(); }
  /// What attempts are compared by: all that are within the tolerance are alike.
  double badness() const {
    return failed_ ? std::numeric_limits<double>::infinity() : std::max(attempt_.off, tolerance);
  }
  bool is_hopeless() const { return failed_ || attempt_.off_pct >= hopeless_pct; }

  /// A sentence for people on how far it is.
  std::string describe_state(std::ptrdiff_t number, std::size_t of) const {
    return fmt::format("attempt {} of {}: frame {} of {}, a handle is off by {:.1f} mm so far",
                       number, of, plan_.animation.first_frame + simulated_ - 1,
                       plan_.animation.last_frame, 1e3 * attempt_.off);
  }

  /// Simulates the next frame.
  void go_on() {
    try {
      if (!animation_) begin();
      for (const AnimatedFrame& frame : animation_->next_frame()) add_frame(attempt_, frame, plan_);
      attempt_.frames = std::max(attempt_.frames, ++simulated_);
    } catch (const Error& error) {
      // whoever stops it knows; anything else the bake itself says, if no attempt is better
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
  Attempt attempt_;
  std::optional<Animation> animation_;
  int simulated_ = 0;  // frames
  bool failed_ = false;
};

/// Says when people have waited long enough for a sign of life.
class FrequentMessage {
 public:
  bool is_due() {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    if (now - last_ < seconds(5)) return false;
    last_ = now;
    return true;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

void add_frame(Attempt& attempt, const AnimatedFrame& frame, const BakePlan& plan) {
  const Shot& shot = plan.shots[frame.sheet_index];
  const double side = longer_side(shot.pattern);
  for (std::size_t h = 0; h < frame.handles.size(); ++h) {
    const HandleFrame& handle = frame.handles[h];
    const double off = handle.error() - unavoidable(plan, frame.sheet_index, shot.handles[h].name);
    attempt.off_pct = std::max(attempt.off_pct, 100 * off / side);
    if (off <= attempt.off) continue;
    attempt.off = off;
    attempt.frame = frame.frame;
  }
}

Attempts::Attempts(const BakeSettings& settings, const BakePlan& plan,
                   std::filesystem::path decision)
    : settings_(settings),
      first_(plan),
      plan_(plan),
      decision_(std::move(decision)),
      seen_(describe_attempt(0)),
      watches_(settings.attempts > 1 && is_hybrid(settings)) {
  if (watches_ && settings.resume == Resume::automatic) watches_ = !load_choice();
}

void Attempts::watch(const AnimatedFrame& frame) {
  if (!watches_ || failing_) return;
  add_frame(seen_, frame, first_);
  const int row = frame.frame - first_.animation.first_frame;
  seen_.frames = row + 1;
  moved_ |= have_moved(first_.shots[frame.sheet_index].handles, row);
  failing_ = moved_ && seen_.off > tolerance;
}

bool have_moved(const std::vector<Handle>& handles, int row) {
  return std::any_of(handles.begin(), handles.end(), [&](const Handle& handle) {
    return (keyed_position(handle, row) - keyed_position(handle, 0)).norm() > tolerance;
  });
}

Attempt Attempts::describe_attempt(std::size_t number) const {
  const bool may_be_finer = !settings_.triangles && !settings_.accuracy && !settings_.budget &&
                            settings_.given.count("base_triangles") == 0;
  Attempt attempt;
  attempt.seed_offset = seed_step * static_cast<unsigned>(number);
  attempt.base_triangles = settings_.base_triangles * (may_be_finer ? refinement(number) : 1);
  return attempt;
}

BakePlan Attempts::plan_of(std::size_t number) const {
  BakePlan plan = first_;
  if (number == 0) return plan;
  const Attempt attempt = describe_attempt(number);
  BakeSettings settings = settings_;
  settings.base_triangles = attempt.base_triangles;
  const auto with_attempt = [&](std::string& hash) {
    hash = hex(content_hash(fmt::format("{} attempt {}", hash, number)));
  };
  for (std::size_t s = 0; s < plan.shots.size(); ++s) {
    plan.seeds[s] += attempt.seed_offset;
    plan.methods[s] = make_method(settings, plan.shots[s], plan.seeds[s], s);
    with_attempt(plan.start_hash[s]);
  }
  with_attempt(plan.simulation_hash);
  return plan;
}

bool Attempts::choose(Progress& progress, StopRequest& stop) {
  std::vector<std::unique_ptr<Candidate>> all;
  for (std::size_t k = 0; k < static_cast<std::size_t>(settings_.attempts); ++k) {
    BakePlan plan = plan_of(k);
    plan.polish = {};
    all.push_back(
        std::make_unique<Candidate>(std::move(plan), k == 0 ? seen_ : describe_attempt(k), stop));
  }
  FrequentMessage frequent;
  const auto best = [&] {
    return std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a->badness() < b->badness();
    });
  };
  for (auto next = best(); !(*next)->is_over() && !(*next)->is_hopeless(); next = best()) {
    if (stop.is_made()) return false;
    if (next != all.begin() && !(*next)->has_begun())
      progress.message(
          fmt::format("attempt {} of {} is tried, because in the attempt before it a handle "
                      "is off by {:.1f} mm",
                      next - all.begin() + 1, all.size(), 1e3 * (*(next - 1))->attempt().off));
    (*next)->go_on();
    if (frequent.is_due())
      progress.message((*next)->describe_state(next - all.begin() + 1, all.size()));
  }
  AttemptChoice choice;
  choice.hopeless = !(*best())->is_over();
  choice.baked = choice.hopeless ? 0 : static_cast<std::size_t>(best() - all.begin());
  for (const auto& candidate : all)
    if (candidate->attempt().frames > 0) choice.tried.push_back(candidate->attempt());
  keep_choice(choice);
  progress.message(describe(choice));
  adopt(std::move(choice));
  has_chosen_ = true;
  return true;
}

void Attempts::adopt(AttemptChoice choice) {
  plan_ = plan_of(choice.baked);
  plan_.attempt = std::move(choice);
  watches_ = failing_ = false;
}

/// What a decision depends on.
std::string Attempts::key() const {
  return fmt::format("{} {} {}", program_key(), scene_input_hash(first_),
                     first_.animation.last_frame);
}

void Attempts::keep_choice(const AttemptChoice& choice) const {
  Json tried = Json::array();
  for (const Attempt& t : choice.tried) tried.push_back({t.off, t.off_pct, t.frame, t.frames});
  write_atomically(decision_, json_line({{"key", key()},
                                         {"baked", choice.baked},
                                         {"hopeless", choice.hopeless},
                                         {"tried", tried}}));
}

bool Attempts::load_choice() {
  AttemptChoice choice;
  try {
    const Json kept = parse_json(read_file(decision_).value_or(""));
    if (kept.at("key") != key()) return false;
    choice.baked = kept.at("baked");
    choice.hopeless = kept.at("hopeless");
    for (const Json& of_attempt : kept.at("tried")) {
      Attempt attempt = describe_attempt(choice.tried.size());
      attempt.off = of_attempt.at(0);
      attempt.off_pct = of_attempt.at(1);
      attempt.frame = of_attempt.at(2);
      attempt.frames = of_attempt.at(3);
      choice.tried.push_back(attempt);
    }
  } catch (const std::exception&) {
    return false;  // there is none, or it is somebody else's
  }
  if (choice.baked >= choice.tried.size()) return false;
  adopt(std::move(choice));
  return true;
}

std::string describe(const AttemptChoice& choice) {
  const Attempt &first = choice.tried.front(), &baked = choice.tried.at(choice.baked);
  std::string text =
      fmt::format("attempts: in the first attempt a handle is off by {:.1f} mm in frame {}",
                  1e3 * first.off, first.frame);
  const auto others = choice.tried.size() - 1;
  if (choice.hopeless)
    return text + fmt::format(
                      "; it is baked, because in all {} attempts a handle is off by {:g} % "
                      "of the sheet or more before the end, and they were given up",
                      choice.tried.size(), hopeless_pct);
  if (choice.baked == 0)
    return text + fmt::format("; it is baked, because {} {} not better", others,
                              others == 1 ? "other is" : "others are");
  text += fmt::format("; attempt {} of {} is baked, where handles are off by {:.2g} mm at most",
                      choice.baked + 1, choice.tried.size(), 1e3 * baked.off);
  if (baked.base_triangles != first.base_triangles)
    text += fmt::format(", on a first mesh of {} triangles", baked.base_triangles);
  return text;
}

}  // namespace paperbake
