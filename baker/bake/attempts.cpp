#include "baker/bake/attempts.h"

#include "baker/bake/candidate.h"
#include "baker/bake/task_queue.h"
#include "baker/job/input_hash.h"
#include "baker/output/checkpoints.h"
#include "baker/output/frequent_message.h"
#include "baker/output/gates.h"
#include "baker/output/output_folder.h"
#include "core/geometry/collider_motion.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace paperbake {
namespace {

constexpr unsigned seed_step = 1000;

/// Starts the next frame of the candidate that is chosen to go on, and on the threads that are free
/// those of the candidates that are most likely to be chosen next.
void start_likeliest(const Candidates& all, Candidate& chosen, int threads) {
  int busy = 0;
  for (const auto& candidate : all) {
    candidate->look();
    busy += candidate->is_busy();
  }
  const std::launch on = launch_policy(threads);
  const auto start = [&](Candidate& candidate) {
    candidate.start(on);
    ++busy;
  };
  if (!chosen.has_frame() && !chosen.is_busy()) start(chosen);
  while (busy < threads) {
    Candidate* likeliest = nullptr;
    for (const auto& candidate : all)
      if (!candidate->is_busy() && candidate->can_go_on() &&
          (!likeliest || candidate->badness_ahead() < likeliest->badness_ahead()))
        likeliest = candidate.get();
    if (!likeliest) return;
    start(*likeliest);
  }
}

Candidates::const_iterator best_of(const Candidates& all) {
  return std::min_element(all.begin(), all.end(),
                          [](const auto& a, const auto& b) { return a->badness() < b->badness(); });
}

}  // namespace

int refinement(std::size_t attempt, AttemptReason reason, int doublings) {
  if (attempt == 0) return 1;
  const bool is_odd = attempt % 2 == 1;
  const int ladder = attempt == attempt_on_finest_mesh     ? 8
                     : reason == AttemptReason::handle_off ? (is_odd ? 2 : 4)
                                                           : (is_odd ? 4 : 8);
  return ladder << doublings;
}

Attempts::Attempts(const BakeSettings& settings, const BakePlan& plan, std::filesystem::path state)
    : settings_(settings),
      first_(plan),
      plan_(plan),
      state_(std::move(state)),
      decision_(state_ / "attempt"),
      seen_(describe_attempt(0)),
      bends_(plan.shots.size()),
      watches_(settings.attempts > 1 && is_hybrid(settings)) {
  if (watches_ && settings.resume == Resume::automatic) watches_ = !load_choice();
}

void Attempts::watch(const AnimatedFrame& frame) {
  if (!watches_ || failing_) return;
  add_frame(seen_, frame, first_);
  if (may_be_finer(settings_)) {
    if (frame.frame == first_.animation.first_frame)
      doublings_at_start_ = std::max(doublings_at_start_, frame.statistics.doublings);
    bends_[frame.sheet_index].look(frame, first_.shots[frame.sheet_index].pattern);
  }
  const int row = frame.frame - first_.animation.first_frame;
  seen_.frames = row + 1;
  const Shot& shot = first_.shots[frame.sheet_index];
  handles_moved_ = handles_moved_ || have_moved(shot.handles, row);
  colliders_moved_ = colliders_moved_ || (shot.colliders && have_moved(*shot.colliders, row));
  failing_ = (handles_moved_ || colliders_moved_) && first_.impossible.empty() &&
             seen_.off > tolerance_of_attempts();
}

bool have_moved(const std::vector<Handle>& handles, int row) {
  return std::any_of(handles.begin(), handles.end(), [&](const Handle& handle) {
    return (keyed_position(handle, row) - keyed_position(handle, 0)).norm() >
           tolerance_of_attempts();
  });
}

bool have_moved(const Colliders& colliders, int row) {
  return farthest_move(colliders, 0, row) > tolerance_of_attempts();
}

bool Attempts::is_doubtful() const {
  if (!watches_ || failing_) return failing_;
  return first_.ends_with_shot && is_mesh_doubted() &&
         last_seen_frame() == first_.animation.last_frame;
}

bool Attempts::is_mesh_doubted() const {
  return watches_ && !failing_ && may_be_finer(settings_) && doublings_at_start_ == 0 &&
         worst_miss(seen_) <= 1 && (seen_.points > 0 || is_coarse());
}

std::string Attempts::caution() const {
  if (first_.ends_with_shot || !is_mesh_doubted()) return {};
  return fmt::format(
      "{}: a bake of the whole shot also tries a finer one, and may come out otherwise",
      why_doubted(seen_));
}

bool Attempts::is_coarse() const {
  return std::any_of(bends_.begin(), bends_.end(),
                     [](const BendWatch& bends) { return bends.is_coarse(); });
}

BakeSettings Attempts::settings_of(std::size_t number) const {
  BakeSettings settings = settings_;
  if (may_be_finer(settings_)) settings.base_triangles *= refinement(number, reason_, doublings_);
  return settings;
}

Attempt Attempts::describe_attempt(std::size_t number) const {
  Attempt attempt;
  attempt.number = number;
  const BakeSettings settings = settings_of(number);
  for (const Shot& shot : first_.shots)
    attempt.base_triangles =
        std::max(attempt.base_triangles, first_triangles(settings, shot.pattern));
  if (reason_ == AttemptReason::handle_off && number != attempt_on_finest_mesh)
    attempt.seed_offset = seed_step * static_cast<unsigned>(number);
  return attempt;
}

BakePlan Attempts::plan_of(std::size_t number) const {
  BakePlan plan = first_;
  if (number == 0) return plan;
  const Attempt attempt = describe_attempt(number);
  plan.animation.checks_mesh = false;
  const BakeSettings settings = settings_of(number);
  const auto with_attempt = [&](std::string& hash) {
    hash = hex(content_hash(fmt::format("{} attempt {}, {}, {}", hash, number, name_of(reason_),
                                        attempt.base_triangles)));
  };
  for (std::size_t s = 0; s < plan.shots.size(); ++s) {
    PlannedSheet& sheet = plan.sheets[s];
    sheet.seed += attempt.seed_offset;
    sheet.method = make_method(settings, plan.shots[s], sheet.seed, s);
    with_attempt(sheet.start_hash);
  }
  with_attempt(plan.simulation_hash);
  return plan;
}

std::filesystem::path Attempts::folder_of(std::size_t number) const {
  // the first one goes on from what is recorded of it, unless that is polished
  if (number == 0 && first_.polish.triangles == 0) return state_;
  return state_ / "attempts" / std::to_string(number);
}

std::unique_ptr<Candidate> Attempts::make_candidate(std::size_t number, AttemptReason reason,
                                                    StopRequest& stop, StageClock& clock) const {
  BakePlan plan = plan_of(number);
  plan.polish = {};
  const std::filesystem::path folder = folder_of(number);
  make_folder(folder);
  const bool goes_on = settings_.resume == Resume::automatic || folder == state_;
  // with as many points as in the first attempt a finer mesh shows that they are the paper's
  const int points = reason_ == AttemptReason::crumpled
                         ? std::min(seen_.points, points_of_a_crumple)
                         : points_of_a_crumple;
  return std::make_unique<Candidate>(
      std::move(plan), number == 0 ? seen_ : describe_attempt(number),
      Comparison{reason, points, allowed_pull()},
      CandidateFolder{folder, goes_on, settings_.checkpoint_every}, stop, clock);
}

/// Half a sentence.
std::string Attempts::why_tried(const Candidate& last) const {
  const Attempt& before = last.known();
  const Gates gates;
  if (last.has_failed()) return "the attempt before it could not be simulated";
  if (reason_ != AttemptReason::handle_off && before.pulled > allowed_pull())
    return fmt::format("in the attempt before it the sheet is pulled off a handle by {:.1f} mm",
                       1e3 * before.pulled);
  if (reason_ != AttemptReason::handle_off && worst_miss(before) <= 1) return why_doubted(before);
  if (before.inside / gates.inside_mm > before.off / gates.handle_err_mm)
    return fmt::format("in the attempt before it the paper is {:.1f} mm inside a collider",
                       1e3 * before.inside);
  return fmt::format("up to frame {} of the attempt before it a handle is off by {:.1f} mm",
                     before.frame, 1e3 * before.off);
}

double Attempts::allowed_pull() const { return std::max(tolerance_of_attempts(), seen_.pulled); }

bool Attempts::may_need_another(const Candidate& last, std::size_t tried) const {
  // a mesh that is doubted is made finer until it is not
  return reason_ != AttemptReason::handle_off && tried < most_attempts() &&
         (last.is_hopeless() || last.badness() > 1) &&
         describe_attempt(tried).base_triangles > last.known().base_triangles;
}

std::size_t Attempts::most_attempts() const {
  const auto allowed = static_cast<std::size_t>(settings_.attempts);
  const std::size_t one_on_each_mesh = may_be_finer(settings_) ? 3 : 2;
  return reason_ == AttemptReason::handle_off && handles_moved_
             ? allowed
             : std::min(allowed, one_on_each_mesh);
}

bool Attempts::search(Candidates& all, std::size_t before, Progress& progress, StopRequest& stop,
                      StageClock& clock) const {
  const std::size_t of = std::max(most_attempts(), before + all.size());
  FrequentMessage frequent;
  for (auto next = best_of(all); !(*next)->is_over() && !(*next)->is_hopeless();
       next = best_of(all)) {
    if (stop.is_made()) return false;
    const std::size_t number = before + (next - all.begin()) + 1;
    if (next != all.begin() && !(*next)->has_begun())
      progress.message(
          fmt::format("attempt {} of {} is tried: {}", number, of, why_tried(**(next - 1))));
    start_likeliest(all, **next, settings_.threads);
    (*next)->show_frame();
    if (frequent.is_due()) progress.message((*next)->describe_state(number, of));
    if (may_need_another(*all.back(), all.size()))
      all.push_back(make_candidate(all.size(), reason_, stop, clock));
  }
  while (all.size() > 1 && !all.back()->has_begun()) all.pop_back();
  return true;
}

bool Attempts::is_crumple_doubted(const Attempt& best) const {
  return reason_ == AttemptReason::handle_off && handles_moved_ && may_be_finer(settings_) &&
         best.points >= points_of_a_crumple && worst_miss(best) <= 1 && settings_.attempts > 2 &&
         describe_attempt(attempt_on_finest_mesh).base_triangles > best.base_triangles;
}

bool Attempts::choose(Progress& progress, StopRequest& stop, StageClock& clock) {
  reason_ = failing_           ? AttemptReason::handle_off
            : seen_.points > 0 ? AttemptReason::crumpled
                               : AttemptReason::coarse;
  seen_.coarse = reason_ == AttemptReason::coarse;
  doublings_ = handles_moved_ ? std::min(doublings_at_start_, doublings_to_bend) : 0;
  Candidates all;
  const std::size_t at_once = reason_ == AttemptReason::handle_off ? most_attempts() : 2;
  while (all.size() < at_once) all.push_back(make_candidate(all.size(), reason_, stop, clock));
  if (!search(all, 0, progress, stop, clock)) return false;
  AttemptChoice choice;
  choice.reason = reason_;
  choice.hopeless = !(*best_of(all))->is_over();
  choice.baked = choice.hopeless ? 0 : static_cast<std::size_t>(best_of(all) - all.begin());
  for (const auto& candidate : all) choice.tried.push_back(candidate->known());
  if (!choice.hopeless && is_crumple_doubted(choice.tried[choice.baked])) {
    const std::size_t before = choice.tried.size();
    progress.message(fmt::format("attempt {} of {} is tried: {}", before + 1,
                                 std::max(most_attempts(), before + 1),
                                 why_doubted(choice.tried[choice.baked])));
    all.clear();
    all.push_back(make_candidate(attempt_on_finest_mesh, AttemptReason::crumpled, stop, clock));
    if (!search(all, before, progress, stop, clock)) return false;
    choice.tried.push_back(all.back()->known());
    if (!all.back()->is_hopeless()) choice.baked = choice.tried.size() - 1;
  }
  all.clear();  // what is still being simulated is not needed
  take_over(choice);
  try {
    keep_choice(choice);
  } catch (const Error& error) {
    progress.warning(fmt::format(
        "which attempt was chosen could not be kept, so that a later bake chooses again: "
        "{} {}",
        error.place, error.cause));
  }
  remove_attempts();
  progress.message(describe(choice));
  adopt(std::move(choice));
  has_chosen_ = true;
  return true;
}

void Attempts::take_over(const AttemptChoice& choice) {
  const std::size_t number = choice.tried[choice.baked].number;
  if (number == 0 && !failing_ && first_.polish.triangles == 0)
    recorded_ = Recorded::everything;
  else if (folder_of(number) == state_)
    recorded_ = Recorded::first_frames;
  else if (first_.polish.triangles == 0)
    move_checkpoints(folder_of(number), state_);
}

void Attempts::remove_attempts() const {
  std::error_code none;
  std::filesystem::remove_all(state_ / "attempts", none);
}

void Attempts::adopt(AttemptChoice choice) {
  const std::size_t number = choice.tried[choice.baked].number;
  if (number > 0) plan_ = plan_of(number);  // else who records the first one goes on
  plan_.attempt = std::move(choice);
  watches_ = failing_ = false;
}

/// What a decision depends on.
std::string Attempts::key() const {
  return fmt::format("{} {} {} {} {}", program_key(), scene_input_hash(first_),
                     first_.animation.last_frame, may_be_finer(settings_) ? "finer" : "as given",
                     settings_.attempts);
}

void Attempts::keep_choice(const AttemptChoice& choice) const {
  Json tried = Json::array();
  for (const Attempt& t : choice.tried)
    tried.push_back({t.number, t.off, t.off_pct, t.frame, t.frames, t.points, t.inside});
  write_atomically(decision_, json_line({{"key", key()},
                                         {"reason", name_of(choice.reason)},
                                         {"baked", choice.baked},
                                         {"hopeless", choice.hopeless},
                                         {"doublings", doublings_},
                                         {"tried", tried}}));
}

bool Attempts::load_choice() {
  AttemptChoice choice;
  try {
    const Json kept = parse_json(read_file(decision_).value_or(""));
    if (kept.at("key") != key()) return false;
    for (const AttemptReason reason :
         {AttemptReason::handle_off, AttemptReason::crumpled, AttemptReason::coarse})
      if (kept.at("reason") == name_of(reason)) choice.reason = reason;
    choice.baked = kept.at("baked");
    choice.hopeless = kept.at("hopeless");
    reason_ = choice.reason;
    doublings_ = kept.at("doublings");
    for (const Json& of_attempt : kept.at("tried")) {
      Attempt attempt = describe_attempt(of_attempt.at(0));
      attempt.off = of_attempt.at(1);
      attempt.off_pct = of_attempt.at(2);
      attempt.frame = of_attempt.at(3);
      attempt.frames = of_attempt.at(4);
      attempt.points = of_attempt.at(5);
      attempt.inside = of_attempt.at(6);
      choice.tried.push_back(attempt);
    }
  } catch (const std::exception&) {
    return false;  // there is none, or it is somebody else's
  }
  if (choice.baked >= choice.tried.size()) return false;
  adopt(std::move(choice));
  return true;
}

}  // namespace paperbake
