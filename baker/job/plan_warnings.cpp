#include "baker/job/plan_warnings.h"

#include "baker/job/method_choice.h"
#include "baker/job/tolerances.h"
#include "core/geometry/collider_depth.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/sheet_distance.h"
#include "core/hands/obstructed_paths.h"
#include "core/model/error.h"
#include "formats/config/job_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace paperbake {

std::string describe(const UnreachablePairOfSheet& impossible) {
  const UnreachablePair& p = impossible.pair;
  const double over = p.apart - p.allowed;
  if (!p.around.empty())
    return fmt::format(
        "Handles \"{}\" and \"{}\" of sheet \"{}\" ask for too much in frames {}-{}: between them "
        "is the part of the sheet that \"{}\" and others hold flat. At frame {} the way round it "
        "is "
        "{:.2f} mm long from ({:.2f}, {:.2f}) to ({:.2f}, {:.2f}) mm of the pattern, the paper "
        "{:.2f} mm: it is {:.2f} mm short.",
        p.a, p.b, impossible.sheet, p.first, p.last, p.around, p.frame, 1e3 * p.apart,
        1e3 * p.from.x(), 1e3 * p.from.y(), 1e3 * p.to.x(), 1e3 * p.to.y(), 1e3 * p.allowed,
        1e3 * over);
  if (p.allowed < 1e-6)
    return fmt::format(
        "Handles \"{}\" and \"{}\" hold the same point of the sheet \"{}\" and part in frames "
        "{}-{}: at frame {} they are {:.2f} mm apart.",
        p.a, p.b, impossible.sheet, p.first, p.last, p.frame, 1e3 * p.apart);
  return fmt::format(
      "Handles \"{}\" and \"{}\" of sheet \"{}\" are too far apart in frames {}-{}: at frame {} "
      "they are asked to be {:.2f} mm apart, "
      "the paper between them is {:.2f} mm long: overshoot {:.2f} mm ({:.1f} %).",
      p.a, p.b, impossible.sheet, p.first, p.last, p.frame, 1e3 * p.apart, 1e3 * p.allowed,
      1e3 * over, 100 * over / p.allowed);
}

namespace {

double overshoot_of(const UnreachablePair& pair) { return pair.apart - pair.allowed; }

/// Whether two handles are too far apart by no more than gates mind, and nothing is in their way.
bool is_slight(const UnreachablePair& pair) {
  return pair.around.empty() &&
         overshoot_of(pair) <= std::min(handle_tolerance, mean_stretch_tolerance * pair.allowed);
}

std::string describe_slightly_apart(const std::vector<UnreachablePair>& pairs,
                                    const std::string& sheet) {
  const UnreachablePair& worst = *std::max_element(
      pairs.begin(), pairs.end(), [](const UnreachablePair& a, const UnreachablePair& b) {
        return overshoot_of(a) < overshoot_of(b);
      });
  return fmt::format(
      "Handles of sheet \"{}\" are keyed up to {:.2f} mm too far apart ({} {}; the worst are "
      "\"{}\" "
      "and \"{}\" at frame {}), as by noise in their keys. They are followed as far as paper can.",
      sheet, 1e3 * overshoot_of(worst), pairs.size(), pairs.size() == 1 ? "pair" : "pairs", worst.a,
      worst.b, worst.frame);
}

}  // namespace

void find_impossible_handles(const BakeSettings& settings, BakePlan& plan) {
  for (const Shot& shot : plan.shots) {
    std::vector<UnreachablePair> slightly;
    for (UnreachablePair& pair : all_impossible_pairs(
             shot.pattern, shot.handles, plan.animation.first_frame, plan.animation.last_frame))
      if (is_slight(pair) && !settings.strict)
        slightly.push_back(std::move(pair));
      else
        plan.impossible.push_back({shot.sheet_name, std::move(pair)});
    if (!slightly.empty())
      plan.warnings.push_back(describe_slightly_apart(slightly, shot.sheet_name));
  }
  std::stable_sort(plan.impossible.begin(), plan.impossible.end(),
                   [](const UnreachablePairOfSheet& a, const UnreachablePairOfSheet& b) {
                     return overshoot_of(a.pair) > overshoot_of(b.pair);
                   });
  if (!settings.strict || plan.impossible.empty()) return;
  const UnreachablePair& pair = plan.impossible.front().pair;
  throw Error(ErrorCode::scene,
              fmt::format("{}, handles \"{}\" and \"{}\", frames {}-{}", settings.scene.string(),
                          pair.a, pair.b, pair.first, pair.last),
              describe(plan.impossible.front()),
              "Bring the handles closer together, or bake without --strict: then they are followed "
              "as far as paper can.");
}

void warn_of_replaced_paper(const BakeSettings& settings, BakePlan& plan) {
  if (!settings.preset || settings.origin("preset") != Origin::command) return;
  const auto is_given = [&](const std::string& key) {
    return std::any_of(settings.set.begin(), settings.set.end(), [&](const SetValue& set) {
      return set.key == key && set.origin == Origin::command;
    });
  };
  std::vector<std::string> replaced;
  const auto add_section = [&](const std::vector<std::string>& keys, const std::string& section) {
    if (!keys.empty())
      replaced.push_back(fmt::format("{} of its [{}]", fmt::join(keys, ", "), section));
  };
  std::vector<std::string> keys;
  for (const SetValue& set : settings.set)
    if (set.origin == Origin::job && !is_given(set.key)) keys.push_back(set.key);
  add_section(keys, "paper");
  for (const JobSection& sheet : settings.sheets) {
    keys.clear();
    for (const JobValue& value : sheet.values)
      if (value.key != "seed" && !is_given(value.key == "gsm" ? "area_density" : value.key))
        keys.push_back(value.key);
    add_section(keys, "sheet." + toml_string(sheet.pattern));
  }
  if (replaced.empty()) return;
  plan.warnings.push_back(
      fmt::format("The preset of the command line replaces the paper of the job, also {}. Give "
                  "what is to stay with --set.",
                  fmt::join(replaced, " and ")));
}

void warn_of_sheets_inside_colliders(const BakeSettings& settings, BakePlan& plan) {
  constexpr double deepest = 1e-4;  // [m] as a gate lets pass
  for (const Shot& shot : plan.shots) {
    if (!shot.colliders) continue;
    for (const Collider& collider : *shot.colliders) {
      const double depth =
          ColliderDepth(collider.mesh()).deepest(shot.start.x, shot.start.triangles).depth;
      if (depth <= deepest) continue;
      const std::string cause =
          fmt::format("The sheet \"{}\" begins {:.2f} mm deep in the collider \"{}\".",
                      shot.sheet_name, 1e3 * depth, collider.mesh().name);
      const char* const remedy =
          "Move one of them apart in the first frame, or give the collider the property "
          "paper_collider = \"inside\" or \"outside\", which says where the paper stays.";
      if (settings.strict) throw Error(ErrorCode::scene, settings.scene.string(), cause, remedy);
      plan.start_faults.push_back({{shot.sheet_name}, cause});
      plan.warnings.push_back(cause + " " + remedy);
    }
  }
}

void warn_of_sheets_in_each_other(BakePlan& plan) {
  const auto warn = [&](const Shot& a, const Shot& b, const std::string& how,
                        const std::string& remedy) {
    const std::string cause =
        fmt::format("The sheets \"{}\" and \"{}\" {}.", a.sheet_name, b.sheet_name, how);
    plan.start_faults.push_back({{a.sheet_name, b.sheet_name}, cause});
    plan.warnings.push_back(cause + " " + remedy);
  };
  constexpr int most_told = 3;
  int in_one_place = 0;
  for (std::size_t j = 0; j < plan.shots.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const Shot &a = plan.shots[i], &b = plan.shots[j];
      if (crossings_between(a.start, b.start) > 0) {
        warn(a, b,
             "pass through each other in the first frame: they are not kept apart where they do",
             "Move one of them, or join them into one mesh.");
        continue;
      }
      // where the middles of two sheets are nearer than this, half of one is in half of the other
      const double thick = (a.paper.thickness + b.paper.thickness) / 4,
                   apart = std::min(distance_of_inside(a.pattern, a.start, b.start, thick),
                                    distance_of_inside(b.pattern, b.start, a.start, thick));
      if (apart >= thick || ++in_one_place > most_told) continue;
      warn(a, b,
           fmt::format("lie {:.3g} mm from each other in the first frame, less than half as far as "
                       "paper is thick: they may pass through each other",
                       1e3 * apart),
           fmt::format("Move one of them away by {:.2g} mm or more.", 1e3 * 2 * thick));
    }
  if (in_one_place > most_told)
    plan.warnings.push_back(fmt::format("{} more pairs of sheets lie as near to each other.",
                                        in_one_place - most_told));
}

void warn_of_coarse_mesh(const BakeSettings& settings, BakePlan& plan) {
  constexpr int fewest = 30;
  const bool hybrid = is_hybrid(settings);
  const int triangles = hybrid ? base_wanted(settings) : triangles_wanted(settings);
  if (triangles >= fewest) return;
  const bool capped = !hybrid || triangles < settings.base_triangles;
  plan.warnings.push_back(
      fmt::format("The mesh {} {} triangles, with which a sheet can hardly bend: is that meant? "
                  "Leave {} out, or give {} or more.",
                  hybrid ? "begins with" : "has", triangles,
                  capped ? "--triangles" : "--base-triangles", 2 * fewest));
}

void warn_of_map_frames(const BakeSettings& settings, BakePlan& plan) {
  if (!settings.map_frames) return;
  for (const FrameSpan& span : *settings.map_frames) {
    bool any = false;
    for (int frame = std::max(span.first, plan.frames.first);
         frame <= std::min(span.last, plan.frames.last); ++frame)
      any |= span.contains(frame) && plan.frames.contains(frame);
    if (any && span.last <= plan.frames.last) continue;
    std::string missing =
        fmt::format("frames {}-{}, of which none is baked", span.first, span.last);
    if (span.first == span.last)
      missing = fmt::format("frame {}, which is not baked", span.first);
    else if (any)
      missing = fmt::format("frames {}-{}, of which those after {} are not baked", span.first,
                            span.last, plan.frames.last);
    plan.warnings.push_back(
        fmt::format("--map-frames asks for {}: the bake has the frames {}-{}{}.", missing,
                    plan.frames.first, plan.frames.last,
                    plan.frames.step > 1 ? fmt::format(" in steps of {}", plan.frames.step) : ""));
  }
}

void warn_of_doubtful_values(BakePlan& plan) {
  constexpr double most_gravity = 100, most_fps = 1000;  // [m/s2] ten times the earth's; [1/s]
  constexpr double most_wind = 60, most_density = 10;    // [m/s]; [kg/m3]
  constexpr double thinnest = 10;                        // [1] sides in thicknesses
  const double gravity = plan.animation.elastic.forces.gravity, fps = plan.animation.fps;
  if (std::abs(gravity) > most_gravity)
    plan.warnings.push_back(
        fmt::format("Gravity is {:g} m/s2, {:.0f} times that of the earth: was it meant in mm/s2 "
                    "or cm/s2? The earth's is 9.81.",
                    gravity, std::abs(gravity) / 9.81));
  else if (gravity < 0)
    plan.warnings.push_back(
        fmt::format("Gravity is {:g} m/s2: it pulls upwards. Downwards is positive.", gravity));
  if (fps > most_fps)
    plan.warnings.push_back(
        fmt::format("There are {:g} frames a second: is that meant? Films have 24.", fps));
  for (const Wind& wind : plan.animation.elastic.air.winds)
    if (const double speed = max_row_norm(wind.velocity); speed > most_wind)
      plan.warnings.push_back(
          fmt::format("The wind \"{}\" blows at {:.0f} m/s: is that meant? A hurricane has 33.",
                      wind.name, speed));
  if (const double density = plan.animation.elastic.air.density; density > most_density)
    plan.warnings.push_back(
        fmt::format("The air has {:g} kg/m3: is that meant? That of the earth has 1.2.", density));
  for (const Shot& shot : plan.shots)
    if (const double width = shorter_side(shot.pattern); width < thinnest * shot.paper.thickness)
      plan.warnings.push_back(
          fmt::format("The sheet \"{}\" is {:.2g} mm wide, and {:.2g} mm thick: is that meant?",
                      shot.sheet_name, 1e3 * width, 1e3 * shot.paper.thickness));
  const Handle* late = nullptr;
  for (const Shot& shot : plan.shots)
    for (const Handle& handle : shot.handles)
      if (handle.release_frame != std::numeric_limits<int>::max() &&
          handle.release_frame > plan.frames.last && !late)
        late = &handle;
  if (late)
    plan.warnings.push_back(
        fmt::format("The handle \"{}\" lets go at frame {}, after the last frame that is baked, "
                    "{}: give --frames {}-{} or more to see it.",
                    late->name, late->release_frame, plan.frames.last, plan.animation.first_frame,
                    late->release_frame + 24));
}

}  // namespace paperbake
