#include "formats/scene/scene_file.h"

#include "core/model/error.h"
#include "formats/scene/scene_colliders.h"
#include "formats/scene/scene_creases.h"
#include "formats/scene/scene_handles.h"
#include "formats/scene/scene_nodes.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/scene_sheets.h"
#include "formats/scene/scene_winds.h"
#include "formats/scene/sheet_rules.h"

#include <fmt/format.h>

namespace paperbake {
namespace {

/// The number that an object gives for the whole scene, without paper_ in front of its name.
std::optional<double> given_number(const SceneNodes& scene, const std::string& what,
                                   std::map<std::string, std::string>& origin) {
  const std::string key = "paper_" + what;
  const auto number = number_of_scene(
      scene.source, scene.file.nodes, key,
      [&](const ImportedNode& node) { return number_property(scene.source, node, key); });
  if (!number) return std::nullopt;
  origin[what] = fmt::format("{} of \"{}\"", key, number->node);
  return number->value;
}

}  // namespace

Scene scene_of(ImportedFile file, std::string source, const SceneOptions& options) {
  const std::vector<AppliedOverrides> overrides = apply_overrides(file, options.overrides);
  const SceneNodes nodes = scene_nodes(std::move(file), std::move(source), options);
  Scene scene;
  scene.source = nodes.source;
  scene.fps = nodes.fps;
  scene.first_frame = nodes.first_frame;
  scene.last_frame = nodes.last_frame;
  scene.origin = nodes.origin;
  scene.warnings = nodes.warnings;
  for (std::string& warning : unknown_properties(nodes.file.nodes))
    scene.warnings.push_back(std::move(warning));
  for (std::string& warning : ignored_instances(nodes.file.nodes))
    scene.warnings.push_back(std::move(warning));
  for (std::string& warning : misspelt_names(nodes.file.nodes))
    scene.warnings.push_back(std::move(warning));
  scene.sheets = read_sheets(nodes, options, overrides, scene.warnings);
  warn_of_keyed_sheets(nodes, scene.warnings);
  add_creases(nodes, scene.sheets, scene.warnings);
  add_handles(nodes, scene.sheets, scene.warnings);
  for (SceneSheet& sheet : scene.sheets) snap_creases_to_points(sheet);
  scene.colliders = read_colliders(nodes, scene.warnings);
  scene.gravity = given_number(nodes, "gravity", scene.origin);
  scene.air = given_number(nodes, "air", scene.origin);
  if (scene.air && *scene.air < 0)
    throw Error(ErrorCode::scene, scene.source, fmt::format("paper_air is {}.", *scene.air),
                "It is the density of the air in kg/m3: 1.2, or 0 for none.");
  scene.winds = read_winds(nodes);
  for (std::size_t i = 0; i < overrides.size(); ++i)
    for (const auto& [key, place] : overrides[i].places) {
      const ImportedNode& node = nodes.file.nodes[i];
      scene.origin[fmt::format("{} of \"{}\"", key, node.name)] = place;
      if (node.meshes.empty())
        scene.given.push_back(
            {node.name, key.substr(std::string("paper_").size()), node.properties.at(key)});
    }
  return scene;
}

Scene read_scene(const std::filesystem::path& path, const SceneOptions& options) {
  return scene_of(import_file(path, options.fps, options.parts), path.filename().string(), options);
}

Tracks read_tracks(const std::filesystem::path& path, const SceneOptions& options) {
  const SceneNodes scene =
      scene_nodes(import_file(path, options.fps, options.parts), path.filename().string(), options);
  const int frames = scene.last_clip_frame - scene.first_clip_frame + 1;
  Tracks tracks;
  tracks.first_frame = scene.first_clip_frame;
  std::vector<int> listed;
  for (int i = 0; i < static_cast<int>(scene.file.nodes.size()); ++i) {
    if (scene.file.nodes[i].pivot) continue;
    listed.push_back(i);
    tracks.names.push_back(scene.file.nodes[i].name);
    tracks.positions.emplace_back(frames, 3);
  }
  for (int f = 0; f < frames; ++f) {
    const auto world = world_at(scene, scene.first_clip_frame + f);
    for (std::size_t i = 0; i < listed.size(); ++i)
      tracks.positions[i].row(f) = origin_of(scene, world, listed[i]);
  }
  return tracks;
}

}  // namespace paperbake
