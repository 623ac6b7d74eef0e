#include "baker/job/plan.h"

#include "baker/job/file_names.h"
#include "baker/job/frames_to_bake.h"
#include "baker/job/version.h"
#include "core/animation/blocked_ways.h"
#include "core/animation/inertia_need.h"
#include "core/animation/refined_animation.h"
#include "core/geometry/collider_depth.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/config/job_file.h"
#include "formats/config/preset_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <set>

namespace paperbake {
namespace {

bool is_hybrid(const BakeSettings& settings) {
  return settings.method == "hybrid" || settings.method == hybrid_and_fem;
}

/// throws Error(ErrorCode::command) when polish is asked for but has no effect
Polishing decided_polishing(const BakeSettings& settings) {
  constexpr int default_triangles = 6000;
  const bool by_method = settings.method == hybrid_and_fem;
  const char* option = by_method ? "--method hybrid+fem" : "--polish";
  if (by_method && settings.polish == 0)
    throw Error(ErrorCode::command, "--polish 0", "Frames of hybrid+fem are polished.",
                "Bake with --method hybrid.");
  if (const int wanted = settings.polish.value_or(0); wanted > 0 && wanted < min_polish_triangles)
    throw Error(ErrorCode::command, fmt::format("--polish {}", wanted),
                "A mesh of so few triangles is coarser than what it would refine.",
                fmt::format("Give at least {}, or 0 for no polish.", min_polish_triangles));
  if (by_method || settings.polish.value_or(0) > 0) {
    if (settings.method == "fem")
      throw Error(ErrorCode::command, option,
                  "There is nothing that fem could improve in its own frames.",
                  "For a finer mesh bake with --triangles N.");
    return {settings.polish.value_or(default_triangles), "asked for with " + std::string(option)};
  }
  if (settings.polish) return {0, "off with --polish 0"};
  const bool hero = settings.quality == Quality::hero && settings.mesh == CacheMesh::render;
  if (hero && settings.method == "hybrid") return {default_triangles, "--quality hero"};
  return {0, settings.method == "fem" ? "fem is at its minimum" : "not asked for"};
}

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

/// What --dynamics would have to say for the same bake.
std::string decided_dynamics(const AnimateOptions& animation) {
  if (animation.elastic.inertia == Inertia::dynamic) return "on";
  return animation.release_inertia == ReleaseInertia::automatic ? "auto" : "off";
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

int triangles_wanted(const BakeSettings& settings) {
  return settings.triangles.value_or(is_hybrid(settings)
                                         ? std::max(1000, 2 * settings.base_triangles)
                                     : settings.method == "adaptive" ? 3000
                                                                     : 1700);
}

/// Triangles that the hybrid starts with: no more than it may have.
int base_wanted(const BakeSettings& settings) {
  const int max_triangles = triangles_wanted(settings);
  if (settings.base_triangles > max_triangles &&
      settings.origin("base_triangles") != Origin::fallback)
    throw Error(ErrorCode::command, fmt::format("--base-triangles {}", settings.base_triangles),
                fmt::format("The mesh may have no more than {} triangles.", max_triangles),
                "Give more with --triangles.");
  return std::min(settings.base_triangles, max_triangles);
}

MethodChoice make_method(const BakeSettings& settings, const Shot& shot, unsigned seed,
                         std::size_t sheet) {
  if (settings.method == "fem") return fem(triangles_wanted(settings));
  if (settings.method == "adaptive") return adaptive(shot.pattern, triangles_wanted(settings));
  CrumpleOptions options;
  options.singular_point_rules = shot.singular_point_rules;
  options.max_triangles = triangles_wanted(settings);
  return hybrid(shot.pattern, shot.paper, base_wanted(settings), options, seed,
                static_cast<std::uint32_t>(sheet));
}

/// Appends the bytes of numbers, for a hash.
template <class Matrix>
void append_bytes(std::string& bytes, const Matrix& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()),
               sizeof(typename Matrix::Scalar) * values.size());
}

std::string start_bytes(const Shot& shot, unsigned seed, const std::string& settings) {
  std::string bytes = settings + shot.sheet_name + fmt::format("/{}/", seed);
  for (const Vector2d& p : shot.pattern.outline) append_bytes(bytes, p);
  for (const auto& hole : shot.pattern.holes)
    for (const Vector2d& p : hole) append_bytes(bytes, p);
  append_bytes(bytes, shot.start.pattern);
  append_bytes(bytes, shot.start.x);
  append_bytes(bytes, shot.start.triangles);
  for (const Vector2d& p : shot.singular_point_rules.fixed) append_bytes(bytes += "keep", p);
  for (const SingularPointRules::Disc& disc : shot.singular_point_rules.forbidden)
    append_bytes(bytes += fmt::format("forbid/{}/", disc.radius), disc.centre);
  for (const PrescribedCrease& fold : shot.pattern.prescribed_creases) {
    bytes += fmt::format("fold/{}/{}/", fold.angle, fold.folded);
    for (const Vector2d& p : fold.line) append_bytes(bytes, p);
  }
  for (const Handle& handle : shot.handles) {
    bytes += fmt::format("{}/{}/{}/{}/{}/{}/", handle.name, int(handle.mode), handle.grab_frame,
                         handle.release_frame, handle.radius.value_or(-1), handle.stiffness);
    append_bytes(bytes, handle.pattern);
  }
  if (shot.colliders)
    for (const Collider& collider : *shot.colliders) {
      bytes += fmt::format("{}/{}/", collider.mesh().name, collider.mesh().friction);
      append_bytes(bytes, collider.mesh().x);
      append_bytes(bytes, collider.mesh().triangles);
    }
  return bytes;
}

/// Bytes of what the caches carry along and the simulation does not look at.
std::string authored_bytes(const Shot& shot) {
  std::string bytes;
  if (!shot.authored) return bytes;
  for (const AuthoredSurface::UvSet& set : shot.authored->uv_sets)
    append_bytes(bytes += fmt::format("uv/{}/", set.name), set.uv);
  for (const std::string& material : shot.authored->materials) bytes += "material/" + material;
  for (const int material : shot.authored->material_of) bytes += fmt::format("/{}", material);
  for (const auto& [key, value] : shot.authored->properties) {
    bytes += fmt::format("/{}/{}/", key, value.index());
    if (const auto* text = std::get_if<std::string>(&value))
      bytes += *text;
    else if (const auto* list = std::get_if<std::vector<double>>(&value))
      bytes += fmt::format("{}", fmt::join(*list, ","));
    else
      bytes += fmt::format("{}", std::get<double>(value));
  }
  return bytes;
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
    while (plan.frames.first < scene.first_frame) plan.frames.first += plan.frames.step;
  }
  plan.frames.last -= (plan.frames.last - plan.frames.first) % plan.frames.step;
  plan.map_frames = settings.map_frames.value_or(
      std::vector<FrameSpan>{{plan.frames.first, plan.frames.last, 12}});
  plan.debug_frames = settings.map_frames.value_or(
      std::vector<FrameSpan>{{plan.frames.first, plan.frames.last, debug_picture_step}});
  plan.animation.first_frame = scene.first_frame;
  plan.animation.last_frame = plan.frames.last;
}

std::string literal(const PropertyValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return toml_string(*text);
  return fmt::format("{}", std::get<double>(value));
}

/// The range of frames, and from which of them on handles rest.
UsedValue used_frames(const BakeSettings& settings, const Scene& scene, const BakePlan& plan) {
  const FrameSpan& frames = plan.frames;
  std::string origin = to_string(settings.origin("frames", Origin::scene));
  if (frames.last > scene.last_frame)
    origin += fmt::format("; handles rest after frame {}, that of the last key", scene.last_frame);
  return {"bake.frames",
          toml_string(fmt::format("{}-{}x{}", frames.first, frames.last, frames.step)),
          std::move(origin)};
}

void record_used_values(const BakeSettings& settings, const Scene& scene, BakePlan& plan) {
  auto& used = plan.used;
  const auto note = [&](const char* table, const char* key, std::string value,
                        Origin otherwise = Origin::fallback) {
    used.push_back({fmt::format("{}.{}", table, key), std::move(value),
                    to_string(settings.origin(key, otherwise))});
  };
  const auto of_scene = [&](const char* option, const char* key) {
    if (settings.given.count(option)) return std::string(to_string(settings.origin(option)));
    const auto found = scene.origin.find(key);
    return found == scene.origin.end() ? std::string("scene") : found->second;
  };
  used.push_back({"scene.file", toml_string(scene.source),
                  to_string(settings.origin("scene", Origin::command))});
  used.push_back({"scene.fps", toml_number(scene.fps), of_scene("fps", "fps")});
  used.push_back({"scene.first_frame", std::to_string(scene.first_frame),
                  of_scene("start_frame", "first_frame")});
  used.push_back({"scene.last_frame", std::to_string(scene.last_frame), "scene"});
  note("bake", "method", toml_string(settings.method));
  note("bake", "triangles", std::to_string(triangles_wanted(settings)));
  if (settings.accuracy) note("bake", "accuracy", toml_number(*settings.accuracy));
  if (settings.budget) note("bake", "budget", toml_number(*settings.budget));
  if (is_hybrid(settings)) note("bake", "base_triangles", std::to_string(base_wanted(settings)));
  note("bake", "polish", std::to_string(plan.polish.triangles),
       settings.method == hybrid_and_fem ? settings.origin("method") : Origin::fallback);
  note("bake", "mesh", settings.mesh == CacheMesh::render ? "\"render\"" : "\"simulation\"");
  if (settings.mesh == CacheMesh::render)
    note("bake", "quality",
         toml_string(settings.quality == Quality::draft  ? "draft"
                     : settings.quality == Quality::hero ? "hero"
                                                         : "shot"));
  note("bake", "stop", toml_number(settings.stop));
  note("bake", "gravity", toml_number(plan.animation.elastic.forces.gravity),
       scene.gravity ? Origin::scene : Origin::fallback);
  const ElasticOptions& elastic = plan.animation.elastic;
  const std::string dynamics = decided_dynamics(plan.animation);
  if (dynamics != "off" && elastic.air.density > 0) {
    note("bake", "air", toml_number(elastic.air.density),
         scene.air ? Origin::scene : Origin::fallback);
    if (settings.wind)
      note("bake", "wind",
           toml_string(fmt::format("{},{},{}", settings.wind->x(), settings.wind->y(),
                                   settings.wind->z())));
  }
  used.push_back(
      {"bake.dynamics", toml_string(dynamics),
       settings.dynamics == Dynamics::automatic ? "auto" : to_string(settings.origin("dynamics"))});
  if (settings.probe_every > 0) note("bake", "probe", std::to_string(settings.probe_every));
  used.push_back(used_frames(settings, scene, plan));
  note("bake", "map_size", std::to_string(settings.map_size));
  note("bake", "map_layout",
       settings.map_layout == MapLayout::scanline ? "\"scanline\"" : "\"tiled-mip\"");
  note("bake", "max_stretch", toml_number(settings.max_stretch_pct));
  note("bake", "strict", settings.strict ? "true" : "false");
  for (const GivenProperty& given : scene.given)
    used.push_back({fmt::format("handle.{}.{}", toml_string(given.handle), given.key),
                    literal(given.value), to_string(Origin::job)});
}

/// Is this a value that no simulated frame depends on?
bool is_of_output(const std::string& key) {
  const char* const keys[] = {"scene.file",      "scene.last_frame", "bake.frames",
                              "bake.mesh",       "bake.quality",     "bake.map_size",
                              "bake.map_layout", "bake.max_stretch", "bake.strict"};
  return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
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

}  // namespace

bool is_method(const std::string& name) {
  return name == "hybrid" || name == "fem" || name == "adaptive" || name == hybrid_and_fem;
}

std::string describe(const SheetImpossible& impossible) {
  const ImpossiblePair& p = impossible.pair;
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

std::string frame_input_hash(const std::string& before, const std::vector<Shot>& shots, int frame,
                             int first_frame) {
  std::string bytes = before;
  for (const Shot& shot : shots) {
    for (const Handle& handle : shot.handles) {
      append_bytes(bytes, keyed_position(handle, frame - first_frame));
      bytes += handle.held(frame) ? 'h' : 'f';
    }
    if (shot.colliders)
      for (const Collider& collider : *shot.colliders)
        if (const auto& frames = collider.frames(); !frames.empty())
          append_bytes(
              bytes,
              frames[std::clamp(frame - first_frame, 0, static_cast<int>(frames.size()) - 1)]);
  }
  return hex(content_hash(bytes));
}

namespace {

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

/// Adds the crease lines of a sheet to the values that were used.
void record_creases(const SceneSheet& sheet, const std::vector<CreaseLine>& lines,
                    std::vector<UsedValue>& used) {
  const std::string table = "sheet." + toml_string(sheet.name);
  std::set<std::string> drawn;
  bool expected = false;
  for (const CreaseLine& line : lines)
    if (line.expected)
      expected = true;
    else
      drawn.insert(line.origin);
  if (!drawn.empty())
    used.push_back({table + ".crease", toml_creases(sheet.pattern.prescribed_creases),
                    fmt::format("{}", fmt::join(drawn, ", "))});
  if (expected)
    used.push_back({table + ".expected_crease", toml_expected(lines), "keys of the handles"});
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
    plan.seeds.push_back(seed);
    plan.presets.push_back(resolved.paper.name);
    std::vector<ExpectedCrease> expected = expected_creases(sheet, plan.animation.first_frame);
    plan.crease_lines.push_back(crease_lines(sheet, expected));
    record_creases(sheet, plan.crease_lines.back(), used);
    plan.shots.push_back(make_shot(std::move(sheet), resolved.paper, scene.colliders));
    add_expected_creases(plan.shots.back(), std::move(expected));
    plan.methods.push_back(make_method(settings, plan.shots.back(), seed, plan.shots.size() - 1));
  }
  return used;
}

/// For several sheets, which may touch, the hash of each with those of all; for one, its own.
std::vector<std::string> with_all(std::vector<std::string> hashes) {
  std::string all;
  for (const std::string& hash : hashes) all += hash;
  if (hashes.size() > 1)
    for (std::string& hash : hashes) hash = hex(content_hash(hash + all));
  return hashes;
}

/// Hashes of everything that the frames, and that the simulated frames alone, depend on.
void hash_inputs(BakePlan& plan) {
  std::string job, values = std::string(program_version) + "\n", of_simulation = values;
  for (const Wind& wind : plan.animation.elastic.air.winds) {
    values += fmt::format("wind/{}/{}/{}/", wind.name, wind.gust, wind.seed);
    append_bytes(values, wind.velocity);
  }
  of_simulation = values;
  for (const UsedValue& value : plan.used) {
    const std::string line = value.key + " = " + value.value + "\n";
    if (value.key != "scene.file") values += line;
    if (!is_of_output(value.key)) of_simulation += line;
  }
  std::vector<std::string> simulated;
  for (std::size_t s = 0; s < plan.shots.size(); ++s) {
    plan.start_hash.push_back(hex(content_hash(start_bytes(plan.shots[s], plan.seeds[s], values))));
    simulated.push_back(
        hex(content_hash(start_bytes(plan.shots[s], plan.seeds[s], of_simulation))));
  }
  plan.start_hash = with_all(std::move(plan.start_hash));
  plan.simulation_hash = with_all(std::move(simulated)).front();
  for (std::string hash : plan.start_hash) {
    for (int f = plan.animation.first_frame; f <= plan.animation.last_frame; ++f)
      hash = frame_input_hash(hash, plan.shots, f, plan.animation.first_frame);
    job += hash;
  }
  for (const Shot& shot : plan.shots) job += authored_bytes(shot);
  plan.job_hash = hex(content_hash(job));
}

/// throws Error(ErrorCode::scene) with --strict when there are some
void find_impossible_handles(const BakeSettings& settings, BakePlan& plan) {
  for (const Shot& shot : plan.shots)
    for (ImpossiblePair& pair : all_impossible_pairs(
             shot.pattern, shot.handles, plan.animation.first_frame, plan.animation.last_frame))
      plan.impossible.push_back({shot.sheet_name, std::move(pair)});
  if (!settings.strict || plan.impossible.empty()) return;
  const ImpossiblePair& pair = plan.impossible.front().pair;
  throw Error(ErrorCode::scene,
              fmt::format("{}, handles \"{}\" and \"{}\", frames {}-{}", settings.scene.string(),
                          pair.a, pair.b, pair.first, pair.last),
              describe(plan.impossible.front()),
              "Bring the handles closer together, or bake without --strict: then they are followed "
              "as far as paper can.");
}

/// Warns of sheets that begin inside a collider. throws Error(ErrorCode::scene) with --strict
void find_begun_inside(const BakeSettings& settings, BakePlan& plan) {
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
      plan.warnings.push_back(cause + " " + remedy);
    }
  }
}

/// Warns of a mesh that is too coarse to bend.
void question_triangles(const BakeSettings& settings, BakePlan& plan) {
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

/// Warns of values that are likely to be meant in another unit, and of releases that come too late.
void question_values(BakePlan& plan) {
  constexpr double most_gravity = 100, most_fps = 1000;  // [m/s2] ten times the earth's; [1/s]
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

void name_files(BakePlan& plan) {
  std::vector<std::string> names;
  for (const Shot& shot : plan.shots) names.push_back(shot.sheet_name);
  plan.file_suffixes = sheet_file_suffixes(names);
  for (const std::string& sentence : describe_shared_names(names))
    plan.warnings.push_back(sentence);
  std::string legal = legal_shot_name(plan.name, plan.file_suffixes);
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
  plan.animation.plasticity = settings.method == "fem" ? Plasticity::off : Plasticity::on;
  decide_frames(settings, scene, plan);
  if (settings.preset)  // an unknown grade is an error even if no sheet uses it
    read_preset(*settings.preset);
  const std::vector<UsedValue> of_sheets = plan_sheets(settings, scene, plan);
  name_files(plan);
  question_triangles(settings, plan);
  question_values(plan);
  find_begun_inside(settings, plan);
  decide_inertia(settings, scene, plan);
  decide_polish(settings, plan);
  record_used_values(settings, scene, plan);
  plan.used.insert(plan.used.end(), of_sheets.begin(), of_sheets.end());
  hash_inputs(plan);
  find_impossible_handles(settings, plan);
  return plan;
}

std::vector<AnimateOptions> options_of_sheets(const BakePlan& plan) {
  std::vector<AnimateOptions> options(plan.shots.size(), plan.animation);
  for (std::size_t s = 0; s < options.size(); ++s)  // sheets of one seed differ
    options[s].seed = plan.seeds[s] + 0x9e3779b9u * static_cast<unsigned>(s);
  return options;
}

void simulate(const BakePlan& plan, const std::vector<AnimateOptions>& options, int threads,
              const std::function<bool(const AnimatedFrame&)>& on_frame) {
  std::vector<AnimatedSheet> sheets;
  for (std::size_t s = 0; s < plan.shots.size(); ++s)
    sheets.push_back({plan.shots[s], plan.methods[s], options[s]});
  if (plan.polish.triangles == 0) return animate_together(sheets, on_frame);
  // for velocities
  const auto wanted = [&](int frame) {
    return plan.frames.contains(frame - 1) || plan.frames.contains(frame) ||
           plan.frames.contains(frame + 1);
  };
  animate_polished(sheets, {plan.polish.triangles, threads, wanted}, on_frame);
}

std::string lock_text(const BakePlan& plan) {
  std::string text = "# Every value of this bake and, behind it, where it came from.\n";
  text += fmt::format("program = \"paperbake\"\nversion = \"{}\"\njob_hash = \"{}\"\n",
                      program_version, plan.job_hash);
  std::string table;
  for (const UsedValue& value : plan.used) {
    const std::size_t dot = value.key.rfind('.');
    if (value.key.substr(0, dot) != table)
      text += fmt::format("\n[{}]\n", table = value.key.substr(0, dot));
    text += fmt::format("{} = {}  # {}\n", value.key.substr(dot + 1), value.value, value.origin);
  }
  return text;
}

}  // namespace paperbake
