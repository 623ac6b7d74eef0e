#include "baker/job/plan.h"

#include "baker/job/file_names.h"
#include "baker/job/frames_to_bake.h"
#include "baker/job/input_hash.h"
#include "baker/job/plan_warnings.h"
#include "baker/job/used_values.h"
#include "core/animation/inertia_need.h"
#include "core/animation/polished_animation.h"
#include "core/geometry/collider_facing.h"
#include "core/hands/expected_creases.h"
#include "core/model/error.h"
#include "formats/config/preset_file.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {
namespace {

/// With --dynamics auto the sheet that needs inertia most decides.
void decide_inertia(const BakeSettings& settings, const Scene& scene, BakePlan& plan) {
  bool dynamic = settings.dynamics == Dynamics::on;
  plan.why_inertia = dynamic ? "asked for with --dynamics on" : "switched off with --dynamics off";
  if (settings.dynamics == Dynamics::automatic) {
    InertiaNeed greatest;
    for (const Shot& shot : plan.shots) {
      InertiaNeed need =
          need_of_inertia(shot, plan.animation.elastic.forces, scene.fps, scene.first_frame,
                          std::max(scene.last_frame, plan.animation.last_frame));
      if (greatest.why.empty() || need.needed > greatest.needed ||
          (need.needed == greatest.needed && need.sway > greatest.sway))
        greatest = std::move(need);
    }
    dynamic = greatest.needed;
    plan.why_inertia = greatest.why;
    if (!dynamic && !plan.animation.elastic.air.winds.empty()) {
      dynamic = true;
      plan.why_inertia = "wind blows";
    }
  }
  plan.animation.elastic.inertia = dynamic ? Inertia::dynamic : Inertia::quasi_static;
  if (settings.dynamics == Dynamics::automatic && !dynamic)
    plan.animation.release_inertia = ReleaseInertia::automatic;
  if (settings.probe_every > 0 && dynamic)
    throw Error(
        ErrorCode::command, "--probe",
        "With inertia a sheet swings between its shapes, so a lower one is not searched for (" +
            plan.why_inertia + ").",
        "Bake with --dynamics off, or without --probe.");
}

/// throws Error(ErrorCode::command) when polish is asked for and the sheets have inertia
void decide_polish(const BakeSettings& settings, BakePlan& plan) {
  plan.polish = decided_polishing(settings);
  if (plan.polish.triangles > 0 && plan.animation.elastic.inertia == Inertia::dynamic) {
    if (settings.polish || settings.method == hybrid_and_fem)
      throw Error(ErrorCode::command, "--polish",
                  "A polished frame is at rest, but the sheets move with inertia (" +
                      plan.why_inertia + ").",
                  "Bake with --dynamics off, or without polish.");
    plan.polish = {0, "a polished frame is at rest, and with inertia none is"};
  }
  plan.method = settings.method;
  if (plan.polish.triangles > 0 && settings.method != hybrid_and_fem) plan.method += "+fem";
}

/// The air of a scene: 1.2 kg/m3 unless it says otherwise; winds only where there is air.
Air air_of(const BakeSettings& settings, const Scene& scene) {
  constexpr double at_sea = 1.2;  // [kg/m3] at 20 degrees
  Air air{settings.air.value_or(scene.air.value_or(at_sea)), scene.winds, scene.fps};
  if (settings.wind && *settings.wind != Vector3d::Zero()) {
    Wind& wind = air.winds.emplace_back();
    wind.name = "--wind";
    wind.velocity = settings.wind->transpose();
  }
  if (air.density == 0) air.winds.clear();
  return air;
}

void decide_frames(const BakeSettings& settings, const Scene& scene, BakePlan& plan) {
  const bool pulled =
      plan.animation.elastic.forces.gravity != 0 || !plan.animation.elastic.air.winds.empty();
  const LastFrame last =
      last_frame_to_bake(scene, pulled ? MovedBy::gravity_or_wind : MovedBy::handles);
  plan.frames = settings.frames.value_or(FrameSpan{scene.first_frame, last.frame, 1});
  if (!settings.frames && !last.why.empty()) plan.warnings.push_back(last.why);
  if (plan.frames.last < scene.first_frame)
    throw Error(ErrorCode::command, "--frames",
                fmt::format("The scene begins at frame {}, the range ends at {}.",
                            scene.first_frame, plan.frames.last),
                fmt::format("The keys cover frames {}-{}.", scene.first_frame, scene.last_frame));
  constexpr int max_frames = 100000;
  if (plan.frames.last - scene.first_frame >= max_frames)
    throw Error(ErrorCode::command, "--frames",
                fmt::format("The range ends at {}: that is more than {} frames.", plan.frames.last,
                            max_frames));
  if (plan.frames.first < scene.first_frame) {
    plan.warnings.push_back(
        fmt::format("--frames begins at {}, before the scene's first frame {}: baked from {}.",
                    plan.frames.first, scene.first_frame, scene.first_frame));
    const int steps = (scene.first_frame - plan.frames.first - 1) / plan.frames.step + 1;
    plan.frames.first += steps * plan.frames.step;
    if (plan.frames.first > plan.frames.last)
      throw Error(ErrorCode::command, "--frames",
                  fmt::format("None of these frames is in the scene, which begins at frame {}.",
                              scene.first_frame),
                  fmt::format("The keys cover frames {}-{}.", scene.first_frame, scene.last_frame));
  }
  if (plan.frames.first > last.frame)
    plan.warnings.push_back(
        fmt::format("--frames begins at {}, after the end of the shot: its last frame is {}, and "
                    "those after it "
                    "show how the paper comes to rest.",
                    plan.frames.first, last.frame));
  plan.ends_with_shot = plan.frames.last >= last.frame;
  plan.frames.last -= (plan.frames.last - plan.frames.first) % plan.frames.step;
  plan.map_frames = settings.map_frames.value_or(
      std::vector<FrameSpan>{{plan.frames.first, plan.frames.last, 12}});
  plan.debug_frames = settings.map_frames.value_or(
      std::vector<FrameSpan>{{plan.frames.first, plan.frames.last, debug_picture_step}});
  plan.animation.first_frame = scene.first_frame;
  plan.animation.last_frame = plan.frames.last;
}

Shot make_shot(SceneSheet&& sheet, const Paper& paper, std::vector<ColliderMesh> colliders) {
  Shot shot{std::move(sheet.name),
            std::move(sheet.pattern),
            std::move(sheet.start),
            std::move(sheet.handles),
            paper,
            std::move(sheet.singular_point_rules)};
  shot.colliders = facing_colliders(std::move(colliders), shot.start.x, shot.handles);
  shot.authored = std::make_shared<const AuthoredSurface>(std::move(sheet.authored));
  return shot;
}

/// throws Error(ErrorCode::command) when options contradict each other
void check_options(const BakeSettings& settings) {
  decided_polishing(settings);
  if (settings.usd_layers && !settings.formats.count("usd") && !settings.formats.count("usdc"))
    throw Error(ErrorCode::command, "--usd-layers on", "The bake writes no USD.",
                "Add usdc or usd to --formats, or leave out --usd-layers.");
  if (settings.mesh != CacheMesh::simulation || settings.method == "fem") return;
  for (const OutputFormat& format : output_formats())
    if (format.needs_one_mesh && settings.formats.count(format.name))
      throw Error(ErrorCode::command, "--formats " + format.name,
                  "A point cache has one mesh for the whole shot, and the simulated one changes.",
                  fmt::format("Leave out --mesh simulation, or {}.", format.name));
}

/// Paper, seed, shot and method of every sheet.
/// returns  the values that were used, for job.lock.toml
std::vector<UsedValue> plan_sheets(const BakeSettings& settings, Scene& scene, BakePlan& plan) {
  std::vector<UsedValue> used;
  for (SceneSheet& sheet : scene.sheets) {
    const ResolvedPaper resolved = resolve_paper(settings, sheet);
    const bool by_sheet =
        sheet.seed && (!settings.seed ||
                       (settings.origin("seed") == Origin::job && sheet.overridden.count("seed")));
    const unsigned seed = by_sheet ? *sheet.seed : settings.seed.value_or(0);
    used.insert(used.end(), resolved.used.begin(), resolved.used.end());
    used.push_back({"paper." + toml_string(sheet.name) + ".seed", std::to_string(seed),
                    to_string(!by_sheet                        ? settings.origin("seed")
                              : sheet.overridden.count("seed") ? Origin::job
                                                               : Origin::scene)});
    PlannedSheet& planned = plan.sheets.emplace_back();
    planned.seed = seed;
    planned.preset = resolved.paper.name;
    std::vector<ExpectedCrease> expected = expected_creases(sheet, plan.animation.first_frame);
    planned.crease_lines = crease_lines(sheet, expected);
    record_creases(sheet, planned.crease_lines, used);
    for (std::string& sentence :
         describe_moved(sheet.name, longer_side(sheet.pattern), planned.crease_lines))
      plan.warnings.push_back(std::move(sentence));
    for (const std::string& sentence : sheet.handles_off)
      plan.start_faults.push_back({{sheet.name}, sentence});
    plan.shots.push_back(make_shot(std::move(sheet), resolved.paper, scene.colliders));
    add_expected_creases(plan.shots.back(), std::move(expected));
    planned.method = make_method(settings, plan.shots.back(), seed, plan.shots.size() - 1);
  }
  return used;
}

void name_files(BakePlan& plan) {
  std::vector<std::string> names;
  for (const Shot& shot : plan.shots) names.push_back(shot.sheet_name);
  const std::vector<std::string> suffixes = sheet_file_suffixes(names);
  for (std::size_t s = 0; s < suffixes.size(); ++s) plan.sheets[s].file_suffix = suffixes[s];
  for (const std::string& sentence : describe_shared_names(names))
    plan.warnings.push_back(sentence);
  std::string legal = legal_shot_name(plan.name, suffixes);
  if (legal != plan.name)
    plan.warnings.push_back(fmt::format(
        "No file can have the name of this shot: the names of the files begin with \"{}\".",
        legal));
  plan.name = std::move(legal);
}

}  // namespace

BakePlan plan_bake(const BakeSettings& settings) {
  check_options(settings);  // before the scene is read, which takes time
  return plan_bake(settings, read_scene(settings.scene, settings.reading));
}

BakePlan plan_bake(const BakeSettings& settings, Scene scene) {
  check_options(settings);
  BakePlan plan;
  plan.name = settings.name.empty() ? settings.scene.stem().string() : settings.name;
  plan.root = settings.root;
  plan.guides = settings.guides;
  plan.usd_layers = settings.usd_layers;
  plan.warnings = scene.warnings;
  plan.animation.fps = scene.fps;
  plan.animation.elastic.stop = settings.stop;
  plan.animation.elastic.forces.gravity = settings.gravity.value_or(scene.gravity.value_or(0.0));
  plan.animation.elastic.air = air_of(settings, scene);
  plan.animation.probe_every = settings.probe_every;
  plan.animation.checks_mesh =
      is_hybrid(settings) && settings.attempts > 1 && may_be_finer(settings);
  plan.animation.plasticity = settings.method == "fem" ? Plasticity::off : Plasticity::on;
  decide_frames(settings, scene, plan);
  if (settings.preset)  // an unknown grade is an error even if no sheet uses it
    read_preset(*settings.preset);
  const std::vector<UsedValue> of_sheets = plan_sheets(settings, scene, plan);
  name_files(plan);
  warn_of_coarse_mesh(settings, plan);
  warn_of_doubtful_values(plan);
  warn_of_replaced_paper(settings, plan);
  warn_of_map_frames(settings, plan);
  warn_of_sheets_inside_colliders(settings, plan);
  warn_of_sheets_in_each_other(plan);
  decide_inertia(settings, scene, plan);
  decide_polish(settings, plan);
  record_used_values(settings, scene, plan);
  plan.used.insert(plan.used.end(), of_sheets.begin(), of_sheets.end());
  hash_inputs(plan);
  find_impossible_handles(settings, plan);
  return plan;
}

bool is_out_of_reach(const BakePlan& plan, const std::string& sheet, const std::string& handle,
                     int frame) {
  return std::any_of(plan.impossible.begin(), plan.impossible.end(),
                     [&](const UnreachablePairOfSheet& i) {
                       return i.sheet == sheet && i.pair.first <= frame && frame <= i.pair.last &&
                              (i.pair.a == handle || i.pair.b == handle);
                     });
}

unsigned seed_of_sheet(const BakePlan& plan, std::size_t sheet) {
  return plan.sheets[sheet].seed + 0x9e3779b9u * static_cast<unsigned>(sheet);
}

std::vector<AnimateOptions> options_of_sheets(const BakePlan& plan) {
  std::vector<AnimateOptions> options(plan.shots.size(), plan.animation);
  for (std::size_t s = 0; s < options.size(); ++s) options[s].seed = seed_of_sheet(plan, s);
  return options;
}

void simulate(const BakePlan& plan, const std::vector<AnimateOptions>& options, int threads,
              const std::function<bool(const AnimatedFrame&)>& on_frame,
              const std::function<bool(const AnimatedFrame&)>& before_polish) {
  std::vector<AnimatedSheet> sheets;
  for (std::size_t s = 0; s < plan.shots.size(); ++s)
    sheets.push_back({plan.shots[s], plan.sheets[s].method, options[s]});
  if (plan.polish.triangles == 0) return animate_together(sheets, on_frame);
  // for velocities
  const auto wanted = [&](int frame) {
    return plan.frames.contains(frame - 1) || plan.frames.contains(frame) ||
           plan.frames.contains(frame + 1);
  };
  animate_polished(sheets, {plan.polish.triangles, threads, wanted, before_polish}, on_frame);
}

}  // namespace paperbake
