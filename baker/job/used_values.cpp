#include "baker/job/used_values.h"

#include "baker/job/method_choice.h"
#include "baker/job/version.h"
#include "formats/config/job_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>
#include <variant>

namespace paperbake {
namespace {

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

/// What --dynamics would have to say for the same bake.
std::string decided_dynamics(const AnimateOptions& animation) {
  if (animation.elastic.inertia == Inertia::dynamic) return "on";
  return animation.release_inertia == ReleaseInertia::automatic ? "auto" : "off";
}

}  // namespace

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
  if (is_hybrid(settings)) note("bake", "attempts", std::to_string(settings.attempts));
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
