#include "formats/scene/scene_nodes.h"

#include "core/model/error.h"
#include "formats/scene/scene_frames.h"
#include "formats/scene/scene_takes.h"

#include <fmt/format.h>

#include <cmath>

namespace paperbake {
namespace {

bool moves(const Motion& motion) {
  return !motion.translation.keys.empty() || !motion.rotation.keys.empty() ||
         !motion.scale.keys.empty();
}

void set_unit(SceneNodes& scene, const SceneOptions& options) {
  if (options.unit_scale && !(*options.unit_scale > 0 && std::isfinite(*options.unit_scale)))
    throw Error(ErrorCode::scene, scene.source,
                fmt::format("A unit of {} m cannot be right.", *options.unit_scale),
                "Give a positive length in metres to --unit-scale.");
  scene.unit = options.unit_scale.value_or(scene.file.unit);
  scene.origin["unit"] = fmt::format("{:.6g} m, {}", scene.unit,
                                     options.unit_scale ? "command line"
                                     : scene.file.fbx   ? "file"
                                                        : "glTF");
  scene.origin["up_axis"] = scene.file.up_axis + (scene.file.fbx ? ", file" : ", glTF");
}

/// A local transform as its part without scale, and the scale.
struct Local {
  Eigen::Affine3d place;
  Vector3d scale;
};

Local local_at(const ImportedNode& node, const Motion& motion, int frame) {
  if (!moves(motion)) return {node.local, node.scale};
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  place.translate(value_at(motion.translation, frame, Vector3d::Zero()));
  place.rotate(value_at(motion.rotation, frame));
  return {place, value_at(motion.scale, frame, Vector3d::Ones())};
}

}  // namespace

SceneNodes scene_nodes(ImportedFile file, std::string source, const SceneOptions& options) {
  SceneNodes scene;
  scene.source = std::move(source);
  scene.file = std::move(file);
  scene.warnings = scene.file.warnings;
  scene.origin["curves"] = scene.file.reader;
  const auto used = merge_takes(scene, options);
  set_fps(scene, options);
  set_frames(scene, options, used);
  set_unit(scene, options);
  return scene;
}

std::vector<Eigen::Affine3d> world_at(const SceneNodes& scene, int frame) {
  struct Placed {
    Eigen::Affine3d world, without_scale;
    Vector3d scale;
  };
  Eigen::Affine3d metres = Eigen::Affine3d::Identity();
  metres.linear() = scene.unit * scene.file.to_z_up;
  const Placed root{metres, metres, Vector3d::Ones()};
  std::vector<Placed> placed;
  std::vector<Eigen::Affine3d> world;
  for (std::size_t i = 0; i < scene.file.nodes.size(); ++i) {
    const ImportedNode& node = scene.file.nodes[i];
    const Placed& parent = node.parent < 0 ? root : placed[node.parent];
    Local local = local_at(node, scene.motions[i], frame);
    if (node.own_scale) {
      local.place.translation() = local.place.translation().cwiseProduct(parent.scale).eval();
      if (node.scale_from >= 0)
        local.scale = local.scale.cwiseProduct(placed[node.scale_from].scale).eval();
    }
    const Eigen::Affine3d place =
        (node.own_scale ? parent.without_scale : parent.world) * local.place;
    placed.push_back({place * Eigen::Scaling(local.scale), place, local.scale});
    world.push_back(placed.back().world);
  }
  return world;
}

Vector3d origin_of(const SceneNodes& scene, const std::vector<Eigen::Affine3d>& world, int node) {
  const auto& nodes = scene.file.nodes;
  int carrier = node;
  for (int above = nodes[node].parent; above >= 0 && nodes[above].offsets_mesh_only;)
    carrier = above = nodes[above].parent;
  return carrier < 0 ? Vector3d::Zero() : Vector3d(world[carrier].translation());
}

}  // namespace paperbake
