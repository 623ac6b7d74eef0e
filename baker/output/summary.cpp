#include "baker/output/summary.h"

#include "baker/job/version.h"
#include "baker/output/file_hash.h"
#include "baker/output/frames_that.h"
#include "baker/output/leaps.h"
#include "baker/output/twin_verdict.h"
#include "core/geometry/measure.h"
#include "core/model/degrees.h"
#include "formats/files/frame_statistics_table.h"
#include "formats/files/json.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <optional>
#include <set>
#include <thread>
#include <type_traits>

namespace paperbake {
namespace {

/// One number over those frames that have it, in the unit of its field: mean, largest, and the
/// frame of the largest. null: no frame has it
template <class Field>
Json spread(const std::vector<FrameRecord>& frames, const Field& field) {
  double sum = 0, largest = 0;
  int count = 0, frame_of_largest = 0;
  for (const FrameRecord& f : frames) {
    const std::optional<double> value = statistic_value(f.statistics, field);
    if (!value) continue;
    if (count++ == 0) frame_of_largest = f.frame;
    sum += *value;
    if (*value > largest) {
      largest = *value;
      frame_of_largest = f.frame;
    }
  }
  if (count == 0) return {};
  return {{"mean", sum / count}, {"max", largest}, {"frame_of_max", frame_of_largest}};
}

/// The numbers of visit_frame_statistics over the shot.
void add_statistics(Json& summary, const std::vector<FrameRecord>& frames) {
  visit_frame_statistics([&](const auto& field) {
    using Value = typename std::decay_t<decltype(field)>::Value;
    if (field.over_shot == ShotValue::none) return;
    Json& place = summary[field.shot_name];
    if (field.over_shot == ShotValue::spread) {
      place = spread(frames, field);
      return;
    }
    Value sum = {}, largest = {};
    int frames_not = 0;
    for (const FrameRecord& f : frames)
      if (const auto* value = find_statistic(f.statistics, field)) {
        sum = static_cast<Value>(sum + *value);
        largest = std::max(largest, *value);
        frames_not += !*value;
      }
    if (field.over_shot == ShotValue::sum) place = sum;
    if (field.over_shot == ShotValue::largest) place = largest;
    if (field.over_shot == ShotValue::frames_not) place = frames_not;
  });
}

std::string describe_colliders(const BakePlan& plan, const std::vector<FrameRecord>& frames) {
  if (!plan.shots.front().colliders) return "none in scene";
  std::vector<std::string> names;
  for (const Collider& collider : *plan.shots.front().colliders)
    names.push_back('"' + collider.mesh().name + '"');
  int touched = 0;
  double inside = 0;
  for (const FrameRecord& f : frames) {
    touched += f.statistics.on_colliders > 0;
    inside = std::max(inside, f.statistics.inside);
  }
  return fmt::format("in scene: {}; touched in {} frames, {:.3f} mm inside at most",
                     fmt::join(names, ", "), touched, 1e3 * inside);
}

/// Friction between layers: the coefficient of every sheet where they differ.
std::string describe_friction(const BakePlan& plan) {
  std::set<double> all;
  for (const Shot& shot : plan.shots) all.insert(shot.paper.friction);
  return all == std::set<double>{0} ? "without friction"
                                    : fmt::format("with friction {}", fmt::join(all, ", "));
}

/// In which frames a sheet passes through another, as a clause; empty: in none.
std::string describe_sheet_intersections(const std::vector<FrameRecord>& frames) {
  const std::string when = frames_that(
      frames, [](const FrameRecord& f) { return f.statistics.crossings_with_others > 0; });
  return when.empty() ? "" : fmt::format("in {} one sheet passes through another", when);
}

/// Whether contact between the sheets of the scene was simulated, and whether it was needed.
Json between_sheets(const BakePlan& plan, const std::vector<FrameRecord>& frames) {
  if (plan.shots.size() < 2) return {{"on", false}, {"why", "one sheet"}};
  if (plan.animation.elastic.contact == SelfContact::off)
    return {{"on", false}, {"why", "contact is off"}};
  const std::string touching =
      frames_that(frames, [](const FrameRecord& f) { return f.statistics.touching_others > 0; });
  std::string why = touching.empty() ? "no sheet comes near another"
                                     : fmt::format("contact: sheets push each other in {}, {}",
                                                   touching, describe_friction(plan));
  if (const std::string through = describe_sheet_intersections(frames); !through.empty())
    why += "; " + through;
  return {{"on", !touching.empty()}, {"why", why}};
}

std::string describe_polish(const BakePlan& plan) {
  const bool several = plan.polish.triangles > 0 && plan.shots.size() > 1;
  return plan.polish.why + (several ? "; each sheet by itself, and frames in which it touches "
                                      "another are left as they were"
                                    : "");
}

/// The air and its winds. A wind is told by its highest speed.
std::string describe_air(const Air& air) {
  std::string text = fmt::format("{} kg/m3, felt by sheets with inertia", air.density);
  for (const Wind& wind : air.winds)
    text += fmt::format(", wind \"{}\" of {:.3g} m/s", wind.name, max_row_norm(wind.velocity));
  return text;
}

/// What was switched on, and why.
Json models(const BakePlan& plan, const std::vector<FrameRecord>& frames) {
  int touching = 0, untangled = 0, births = 0, with_inertia = 0;
  for (const FrameRecord& f : frames) {
    with_inertia += f.statistics.inertia;
    touching += f.statistics.touching > 0;
    untangled += f.statistics.render && f.statistics.render->kept_apart;
    births += f.statistics.new_singular;
  }
  const ElasticOptions& elastic = plan.animation.elastic;
  const bool dynamic = elastic.inertia == Inertia::dynamic;
  const std::string& method = plan.sheets.front().method.name;
  const bool yields = plan.animation.plasticity == Plasticity::on, singular = method == "hybrid";
  const std::string let_go = dynamic || with_inertia == 0
                                 ? ""
                                 : fmt::format(
                                       "; in {} frames a sheet that was let go, or that gave way "
                                       "to its weight, has inertia",
                                       with_inertia);
  const auto model = [](bool on, const std::string& why) { return Json{{"on", on}, {"why", why}}; };
  return {
      {"dynamics", model(dynamic, plan.why_inertia + let_go)},
      {"gravity",
       model(elastic.forces.gravity != 0, fmt::format("{} m/s2", elastic.forces.gravity))},
      {"air", model(with_inertia > 0 && elastic.air.density > 0, describe_air(elastic.air))},
      {"plasticity",
       model(yields, yields ? "paper that yields keeps its creases" : "method fem is elastic")},
      {"singular_points",
       model(singular,
             !singular ? "method " + method + " makes none"
             : births  ? fmt::format("{} were born where two bending directions conflicted", births)
                       : "looked for; no two bending directions conflicted for long enough")},
      {"contact", model(touching > 0,
                        touching > 0 ? fmt::format("the sheet comes near itself in {} frames, {}",
                                                   touching, describe_friction(plan))
                                     : "the sheet never comes near itself")},
      {"layers_apart",
       model(untangled > 0,
             untangled > 0
                 ? fmt::format("the curved sheet would have passed through itself in {} frames",
                               untangled)
                 : "the curved sheet never passes through itself")},
      {"between_sheets", between_sheets(plan, frames)},
      {"polish", model(plan.polish.triangles > 0, describe_polish(plan))},
      {"colliders",
       model(plan.shots.front().colliders != nullptr, describe_colliders(plan, frames))}};
}

Json sheets_of(const BakePlan& plan) {
  Json sheets = Json::array();
  for (std::size_t s = 0; s < plan.shots.size(); ++s)
    sheets.push_back({{"name", plan.shots[s].sheet_name},
                      {"preset", plan.sheets[s].preset},
                      {"files", plan.name + plan.sheets[s].file_suffix},
                      {"seed", plan.sheets[s].seed},
                      {"width_m", extent(plan.shots[s].pattern).x()},
                      {"height_m", extent(plan.shots[s].pattern).y()},
                      {"handles", plan.shots[s].handles.size()}});
  return sheets;
}

Json crease_lines(const BakePlan& plan, const SummaryCreases& creases) {
  Json lines = Json::array();
  for (std::size_t s = 0; s < plan.shots.size(); ++s) {
    std::vector<CreaseLine> all = plan.sheets[s].crease_lines;
    all.insert(all.end(), creases.found[s].begin(), creases.found[s].end());
    for (std::size_t k = 0; k < all.size(); ++k) {
      const CreaseLine& crease = all[k];
      Json line = Json::array();
      for (const Vector2d& p : crease.line) line.push_back({1e3 * p.x(), 1e3 * p.y()});
      const std::optional<int>& folded = creases.frames_of_folding[s][k];
      lines.push_back({{"sheet", plan.shots[s].sheet_name},
                       {"id", k + 1},
                       {"line_mm", line},
                       {"angle_deg", degrees_of(crease.angle)},
                       {"expected", crease.expected},
                       {"from", crease.origin},
                       {"folded_in_frame", folded ? Json(*folded) : Json()}});
    }
  }
  return lines;
}

Json accuracy_choice(const BakePlan& plan) {
  if (!plan.accuracy) return {};
  const AccuracyChoice& choice = *plan.accuracy;
  const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(); };
  Json tried = Json::array();
  for (const TriedSize& t : choice.tried)
    tried.push_back(
        {{choice.size_option, t.size}, {"error_pct", or_null(t.error_pct)}, {"cpu_s", t.seconds}});
  return {{"asked_pct", or_null(choice.asked_pct)},
          {"budget_s", or_null(choice.budget_seconds)},
          {"method", choice.method},
          {choice.size_option, choice.size},
          {"error_pct", choice.frame_error_pct.empty() ? Json() : Json(choice.error_pct)},
          {"reached", choice.is_reached},
          {"parts_in_frame", or_null(choice.parts_in_frame)},
          {"why_parts", choice.why_parts.empty() ? Json() : Json(choice.why_parts)},
          {"frame_error_pct", choice.frame_error_pct},
          {"tried", tried}};
}

/// null: there was one attempt
Json attempts_json(const BakePlan& plan) {
  if (!plan.attempt) return {};
  Json tried = Json::array();
  for (const Attempt& t : plan.attempt->tried)
    tried.push_back({{"seed_offset", t.seed_offset},
                     {"base_triangles", t.base_triangles},
                     {"frames", t.frames},
                     {"crumpled", t.points >= points_of_a_crumple},
                     {"points", t.points},
                     {"off_mm", 1e3 * t.off},
                     {"off_pct", t.off_pct},
                     {"frame_of_off", t.frame},
                     {"inside_mm", 1e3 * t.inside}});
  return {{"reason", name_of(plan.attempt->reason)},
          {"baked", plan.attempt->baked + 1},
          {"tried", tried}};
}

/// null: the bake has no twin
Json twin_json(const std::vector<FrameRecord>& frames) {
  const std::optional<TwinVerdict> verdict = twin_verdict(frames);
  if (!verdict) return {};
  return {{"jitter_m", twin_jitter},
          {"limit_pct", 100 * twin_limit},
          {"chaotic_from", verdict->chaotic_from ? Json(*verdict->chaotic_from) : Json()},
          {"largest_pct", 100 * verdict->largest},
          {"frame_of_largest", verdict->frame_of_largest}};
}

Json leaps_json(const std::vector<FrameRecord>& frames, const BakePlan& plan) {
  Json leaps = Json::array();
  for (const Leap& leap : find_leaps(frames, plan))
    leaps.push_back({{"frame", leap.frame},
                     {"sheet", leap.sheet},
                     {"moved_mm", 1e3 * leap.moved},
                     {"around_mm", 1e3 * leap.around}});
  return leaps;
}

Json impossible_handles(const BakePlan& plan) {
  Json impossible = Json::array();
  for (const UnreachablePairOfSheet& i : plan.impossible)
    impossible.push_back({{"sheet", i.sheet},
                          {"handles", {i.pair.a, i.pair.b}},
                          {"frame", i.pair.frame},
                          {"frames", {i.pair.first, i.pair.last}},
                          {"apart_mm", 1e3 * i.pair.apart},
                          {"paper_mm", 1e3 * i.pair.allowed},
                          {"overshoot_mm", 1e3 * (i.pair.apart - i.pair.allowed)},
                          {"around", i.pair.around.empty() ? Json() : Json(i.pair.around)}});
  return impossible;
}

}  // namespace

std::string machine_name() {
  std::string line;
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line))
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string summary_json(const BakePlan& plan, const std::vector<FrameRecord>& frames,
                         const SummaryCreases& creases, const SummaryEnding& ending,
                         const std::map<std::string, std::string>& files) {
  Json settings = Json::object();
  for (const UsedValue& value : plan.used) settings[value.key] = value.value;
  const auto jammed = std::count_if(frames.begin(), frames.end(),
                                    [](const FrameRecord& f) { return !f.jammed.empty(); });
  Json summary{{"program", "paperbake"},         {"version", program_version},
               {"job_hash", plan.job_hash},      {"method", plan.method},
               {"fps", plan.animation.fps},      {"first_frame", plan.frames.first},
               {"last_frame", plan.frames.last}, {"frames", frames.size()},
               {"sheets", sheets_of(plan)}};
  add_statistics(summary, frames);
  summary.update(
      {{"crease_length_m", creases.length},
       {"creases", crease_lines(plan, creases)},
       {"accuracy", accuracy_choice(plan)},
       {"attempts", attempts_json(plan)},
       {"jammed_frames", jammed},
       {"impossible_handles", impossible_handles(plan)},
       {"twin", twin_json(frames)},
       {"leaps", leaps_json(frames, plan)},
       {"gates_missed", ending.missed_gates},
       {"exit_code", ending.exit_code},
       {"failure", ending.failure.empty() ? Json() : Json(ending.failure)},
       {"models", models(plan, frames)},
       {"cpu_s", ending.cpu_s},
       {"warnings", plan.warnings},
       {"settings", settings},
       {"machine", {{"cpu", machine_name()}, {"cores", std::thread::hardware_concurrency()}}},
       {"files", files}});
  return sealed(json_lines(summary));
}

}  // namespace paperbake
