#include "formats/scene/scene_takes.h"

#include "core/model/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <tuple>
#include <type_traits>

namespace paperbake {
namespace {

bool varies(const Motion& motion) {
  bool varies = false;
  const auto numbers = [](const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Vector3d>)
      return value;
    else
      return Eigen::Vector4d(value.coeffs());
  };
  for_each_track(motion, [&](const auto& track) {
    for (const auto& key : track.keys)
      varies |= !numbers(key.value).isApprox(numbers(track.keys.front().value), 1e-6);
    for (const auto& tangents : track.tangents)
      varies |= numbers(tangents.in).norm() + numbers(tangents.out).norm() > 1e-6;
  });
  return varies;
}

std::vector<const Take*> wanted_takes(const SceneNodes& scene, const SceneOptions& options) {
  std::vector<const Take*> takes;
  std::vector<std::string> names;
  for (const Take& take : scene.file.takes) {
    names.push_back('"' + take.name + '"');
    if (!options.take || *options.take == take.name) takes.push_back(&take);
  }
  if (options.take && takes.empty())
    throw Error(ErrorCode::scene, scene.source,
                fmt::format("The file has no take \"{}\".", *options.take),
                names.empty() ? "It has no animation."
                              : fmt::format("--take must be one of {}; without --take all of them "
                                            "are merged.",
                                            fmt::join(names, ", ")));
  return takes;
}

/// Groups each node of the file with the pivots that FBX import puts above it: they must follow the
/// same take.
std::vector<std::vector<int>> nodes_with_their_pivots(const std::vector<ImportedNode>& nodes) {
  std::vector<std::vector<int>> groups;
  std::map<std::string, std::size_t> group_of_pivots;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    const auto known = group_of_pivots.find(nodes[i].name);
    if (known != group_of_pivots.end()) {
      groups[known->second].push_back(i);
    } else {
      if (nodes[i].pivot) group_of_pivots.emplace(nodes[i].name, groups.size());
      groups.push_back({i});
    }
  }
  return groups;
}

/// Whether a motion passes through the rest position of its node: then the node was exported while
/// this take moved it.
bool passes_rest(const Motion& motion, const ImportedNode& node) {
  constexpr int parts = 8;       // samples between two keys
  constexpr double near = 0.05;  // of the size of the path
  double nearest = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox3d path;
  for (std::size_t k = 0; k < motion.key_times.size(); ++k)
    for (int part = 0; part < (k + 1 < motion.key_times.size() ? parts : 1); ++part) {
      const double step = part > 0 ? (motion.key_times[k + 1] - motion.key_times[k]) / parts : 0;
      const Vector3d at =
          value_at(motion.translation, motion.key_times[k] + part * step, Vector3d::Zero());
      path.extend(at);
      nearest = std::min(nearest, (at - node.local.translation()).norm());
    }
  return nearest <=
         std::max(near * path.diagonal().norm(),
                  1e-5 * path.max().cwiseAbs().cwiseMax(path.min().cwiseAbs()).maxCoeff());
}

/// A take that a node can follow, and how well it fits. Blender writes an animation for each
/// object, or for each action and object: those of the actions of other objects have two equal
/// keys, or move the node to where the other object is.
struct TakeChoice {
  const Take* take = nullptr;
  bool varies = false, from_rest = true;
  std::size_t keys = 0;
  int moving_takes = 0;
};

TakeChoice choose_take(const SceneNodes& scene, const std::vector<const Take*>& takes,
                       const std::vector<int>& group) {
  TakeChoice best;
  for (const Take* take : takes) {
    TakeChoice choice{take, false, true, 0, best.moving_takes};
    for (int node : group) {
      const auto motion = take->motions.find(node);
      if (motion == take->motions.end()) continue;
      choice.keys += motion->second.key_times.size();
      choice.varies |= varies(motion->second);
      choice.from_rest &= passes_rest(motion->second, scene.file.nodes[node]);
    }
    if (choice.keys == 0) continue;
    if (choice.varies) best.moving_takes = ++choice.moving_takes;
    if (!best.take || std::tuple(choice.varies, choice.from_rest, choice.keys) >
                          std::tuple(best.varies, best.from_rest, best.keys))
      best = choice;
  }
  return best;
}

}  // namespace

std::vector<const Take*> merge_takes(SceneNodes& scene, const SceneOptions& options) {
  const auto takes = wanted_takes(scene, options);
  std::vector<const Take*> used;
  std::vector<std::string> contested;
  scene.motions.resize(scene.file.nodes.size());
  for (const std::vector<int>& group : nodes_with_their_pivots(scene.file.nodes)) {
    const TakeChoice choice = choose_take(scene, takes, group);
    if (!choice.take) continue;
    if (std::find(used.begin(), used.end(), choice.take) == used.end()) used.push_back(choice.take);
    const std::string& name = scene.file.nodes[group.front()].name;
    if (choice.moving_takes > 1)
      contested.push_back(fmt::format("\"{}\" (\"{}\" is used)", name, choice.take->name));
    for (int node : group) {
      const auto motion = choice.take->motions.find(node);
      if (motion != choice.take->motions.end()) scene.motions[node] = motion->second;
    }
  }
  scene.shapes.resize(scene.file.nodes.size());
  for (const Take* take : takes)
    for (const auto& [node, tracks] : take->shapes)
      if (scene.shapes[node].empty()) {
        scene.shapes[node] = tracks;
        if (std::find(used.begin(), used.end(), take) == used.end()) used.push_back(take);
      }
  if (!contested.empty())
    scene.warnings.push_back(fmt::format(
        "{} node(s) are moved by several takes, first {}: --take NAME chooses one for all.",
        contested.size(), contested.front()));
  scene.origin["takes"] =
      options.take ? "command line" : fmt::format("{} of {} merged", used.size(), takes.size());
  return used;
}

}  // namespace paperbake
