#include "baker/output/summary.h"

#include "baker/output/file_hash.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <thread>

namespace paperbake {
namespace {

using Json = nlohmann::ordered_json;

/// Mean and largest of one number over the frames, with the frame of the largest.
Json spread(const std::vector<FrameRecord>& frames,
            const std::function<double(const FrameRecord&)>& value) {
  double sum = 0, largest = 0;
  int at = frames.empty() ? 0 : frames.front().frame;
  for (const FrameRecord& f : frames) {
    sum += value(f);
    if (value(f) > largest) largest = value(f), at = f.frame;
  }
  return {
      {"mean", frames.empty() ? 0 : sum / frames.size()}, {"max", largest}, {"frame_of_max", at}};
}

/// The same over the frames that were rendered; null when none was.
Json render_spread(const std::vector<FrameRecord>& frames,
                   const std::function<double(const RenderNumbers&)>& value) {
  std::vector<FrameRecord> rendered;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(rendered),
               [](const FrameRecord& f) { return f.render.has_value(); });
  return rendered.empty()
             ? Json()
             : spread(rendered, [&](const FrameRecord& f) { return value(*f.render); });
}

std::string describe_colliders(const BakePlan& plan, const std::vector<FrameRecord>& frames) {
  if (!plan.shots.front().colliders) return "none in scene";
  std::vector<std::string> names;
  for (const Collider& collider : *plan.shots.front().colliders)
    names.push_back('"' + collider.mesh().name + '"');
  const auto touched = std::count_if(frames.begin(), frames.end(),
                                     [](const FrameRecord& f) { return f.on_colliders > 0; });
  double inside = 0;
  for (const FrameRecord& f : frames) inside = std::max(inside, f.inside_mm);
  return fmt::format("in scene: {}; touched in {} frames, {:.3f} mm inside at most",
                     fmt::join(names, ", "), touched, inside);
}

/// Of layers on layers: the coefficient of every sheet where they differ.
std::string describe_friction(const BakePlan& plan) {
  std::set<double> all;
  for (const Shot& shot : plan.shots) all.insert(shot.paper.friction);
  return all == std::set<double>{0} ? "without friction"
                                    : fmt::format("with friction {}", fmt::join(all, ", "));
}

/// Do the sheets of the scene push each other, and did they?
Json between_sheets(const BakePlan& plan, const std::vector<FrameRecord>& frames) {
  if (plan.shots.size() < 2) return {{"on", false}, {"why", "one sheet"}};
  if (plan.animation.elastic.contact == SelfContact::off)
    return {{"on", false}, {"why", "contact is off"}};
  std::set<int> touching;
  for (const FrameRecord& f : frames)
    if (f.touching_others > 0) touching.insert(f.frame);
  std::string why =
      touching.empty()
          ? "no sheet comes near another"
          : fmt::format("contact: sheets push each other in {} frames from {} to {}, {}",
                        touching.size(), *touching.begin(), *touching.rbegin(),
                        describe_friction(plan));
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

Json models(const BakePlan& plan, const std::vector<FrameRecord>& frames) {
  const auto touching = std::count_if(frames.begin(), frames.end(),
                                      [](const FrameRecord& f) { return f.touching > 0; });
  const auto apart = std::count_if(frames.begin(), frames.end(), [](const FrameRecord& f) {
    return f.render && f.render->kept_apart;
  });
  const ElasticOptions& elastic = plan.animation.elastic;
  const bool dynamic = elastic.inertia == Inertia::dynamic;
  const std::string& method = plan.methods.front().name;
  const bool yields = plan.animation.memory == Memory::plastic, singular = method == "hybrid";
  const int births =
      std::accumulate(frames.begin(), frames.end(), 0,
                      [](int sum, const FrameRecord& f) { return sum + f.new_singular; });
  const auto model = [](bool on, const std::string& why) { return Json{{"on", on}, {"why", why}}; };
  return {
      {"dynamics", model(dynamic, plan.why_inertia)},
      {"gravity", model(elastic.gravity != 0, fmt::format("{} m/s2", elastic.gravity))},
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
       model(apart > 0,
             apart > 0
                 ? fmt::format("the curved sheet would have passed through itself in {} frames",
                               apart)
                 : "the curved sheet never passes through itself")},
      {"between_sheets", between_sheets(plan, frames)},
      {"polish", model(plan.polish.triangles > 0, describe_polish(plan))},
      {"colliders",
       model(plan.shots.front().colliders != nullptr, describe_colliders(plan, frames))}};
}

}  // namespace

std::string machine_name() {
  std::string line;
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line))
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::vector<std::string> missed_gates(const Gates& gates, const std::vector<FrameRecord>& frames,
                                      const BakePlan& plan) {
  std::vector<std::string> missed;
  const auto check = [&](double limit, const std::function<double(const FrameRecord&)>& value,
                         const char* sentence) {
    const auto worst = std::max_element(
        frames.begin(), frames.end(),
        [&](const FrameRecord& a, const FrameRecord& b) { return value(a) < value(b); });
    if (worst != frames.end() && value(*worst) > limit)
      missed.push_back(fmt::format(fmt::runtime(sentence), fmt::arg("frame", worst->frame),
                                   fmt::arg("value", value(*worst)), fmt::arg("limit", limit)));
  };
  check(
      gates.mean_stretch_pct, [](const FrameRecord& f) { return f.stretch_mean_pct; },
      "Frame {frame}: mean stretch {value:.2f} %, more than {limit:g} %.");
  check(
      gates.max_stretch_pct, [](const FrameRecord& f) { return f.stretch_max_pct; },
      "Frame {frame}: an edge is off by {value:.2f} %, more than {limit:g} %.");
  check(
      gates.handle_err_mm, [](const FrameRecord& f) { return f.handle_err_max_mm; },
      "Frame {frame}: a handle is off by {value:.2f} mm, more than {limit:g} mm.");
  check(
      0, [](const FrameRecord& f) { return double(f.crossings); },
      "Frame {frame}: {value:.0f} pairs of triangles pass through each other.");
  check(
      0, [](const FrameRecord& f) { return f.render ? double(f.render->crossings) : 0; },
      "Frame {frame}: {value:.0f} pairs of rendered triangles pass through each other.");
  // where they pass through each other as simulated, as those joined at a border do, so will the
  // rendered ones
  std::set<int> crossed;
  for (const FrameRecord& f : frames)
    if (f.crossings_with_others > 0) crossed.insert(f.frame);
  check(
      0,
      [&](const FrameRecord& f) {
        return f.render && !crossed.count(f.frame) ? double(f.render->crossings_with_others) : 0;
      },
      "Frame {frame}: {value:.0f} pairs of rendered triangles of two sheets pass through each "
      "other.");
  if (!plan.impossible.empty())
    missed.push_back(
        fmt::format("{} pairs of handles ask for more than paper can reach; the worst: {}",
                    plan.impossible.size(), describe(plan.impossible.front())));
  return missed;
}

std::string describe_sheet_intersections(const std::vector<FrameRecord>& frames) {
  std::set<int> through;
  for (const FrameRecord& f : frames)
    if (f.crossings_with_others > 0) through.insert(f.frame);
  if (through.empty()) return "";
  return fmt::format("in {} frames from {} to {} one sheet passes through another", through.size(),
                     *through.begin(), *through.rbegin());
}

std::string summary_json(const BakePlan& plan, const std::vector<FrameRecord>& frames,
                         double crease_length, const std::vector<std::string>& missed,
                         int exit_code, const std::string& failure,
                         const std::map<std::string, std::string>& files) {
  Json sheets = Json::array(), impossible = Json::array(), settings = Json::object();
  for (std::size_t s = 0; s < plan.shots.size(); ++s)
    sheets.push_back({{"name", plan.shots[s].sheet_name},
                      {"preset", plan.presets[s]},
                      {"seed", plan.seeds[s]},
                      {"width_m", extent(plan.shots[s].pattern).x()},
                      {"height_m", extent(plan.shots[s].pattern).y()},
                      {"handles", plan.shots[s].handles.size()}});
  for (const SheetImpossible& i : plan.impossible)
    impossible.push_back({{"sheet", i.sheet},
                          {"handles", {i.pair.a, i.pair.b}},
                          {"frame", i.pair.frame},
                          {"frames", {i.pair.first, i.pair.last}},
                          {"apart_mm", 1e3 * i.pair.apart},
                          {"paper_mm", 1e3 * i.pair.allowed},
                          {"overshoot_mm", 1e3 * (i.pair.apart - i.pair.allowed)}});
  for (const UsedValue& value : plan.used) settings[value.key] = value.value;
  const auto count = [&](auto test) { return std::count_if(frames.begin(), frames.end(), test); };
  int singular = 0, crossings = 0;
  for (const FrameRecord& f : frames)
    singular += f.new_singular, crossings = std::max(crossings, f.crossings);

  const Json summary{
      {"program", "paperbake"},
      {"version", PAPERBAKE_VERSION},
      {"job_hash", plan.job_hash},
      {"method", plan.method},
      {"fps", plan.animation.fps},
      {"first_frame", plan.frames.first},
      {"last_frame", plan.frames.last},
      {"frames", frames.size()},
      {"sheets", sheets},
      {"triangles", spread(frames, [](const FrameRecord& f) { return double(f.triangles); })},
      {"stretch_mean_pct", spread(frames, [](const FrameRecord& f) { return f.stretch_mean_pct; })},
      {"stretch_max_pct", spread(frames, [](const FrameRecord& f) { return f.stretch_max_pct; })},
      {"angle_defect_max_deg",
       spread(frames, [](const FrameRecord& f) { return f.angle_defect_max_deg; })},
      {"handle_err_max_mm",
       spread(frames, [](const FrameRecord& f) { return f.handle_err_max_mm; })},
      {"render_stretch_mean_pct",
       render_spread(frames, [](const RenderNumbers& r) { return r.stretch_mean_pct; })},
      {"render_stretch_max_pct",
       render_spread(frames, [](const RenderNumbers& r) { return r.stretch_max_pct; })},
      {"render_triangles",
       render_spread(frames, [](const RenderNumbers& r) { return double(r.triangles); })},
      {"render_ms", render_spread(frames, [](const RenderNumbers& r) { return r.ms; })},
      {"render_crossings",
       render_spread(frames, [](const RenderNumbers& r) { return double(r.crossings); })},
      {"render_crossings_with_others",
       render_spread(frames,
                     [](const RenderNumbers& r) { return double(r.crossings_with_others); })},
      {"elastic_ms", spread(frames, [](const FrameRecord& f) { return f.elastic_ms; })},
      {"geometry_ms", spread(frames, [](const FrameRecord& f) { return f.geometry_ms; })},
      {"newton_iterations",
       spread(frames, [](const FrameRecord& f) { return double(f.newton_iterations); })},
      {"energy_J", spread(frames, [](const FrameRecord& f) { return f.energy_J; })},
      {"singular", singular},
      {"crease_length_m", crease_length},
      {"crossings", crossings},
      {"not_converged", count([](const FrameRecord& f) { return !f.converged; })},
      {"jammed_frames", count([](const FrameRecord& f) { return !f.jammed.empty(); })},
      {"impossible_handles", impossible},
      {"gates_missed", missed},
      {"exit_code", exit_code},
      {"failure", failure.empty() ? Json() : Json(failure)},
      {"models", models(plan, frames)},
      {"warnings", plan.warnings},
      {"settings", settings},
      {"machine", {{"cpu", machine_name()}, {"cores", std::thread::hardware_concurrency()}}},
      {"files", files}};
  return sealed(summary.dump(1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace paperbake
