#include "formats/scene_nodes.h"

#include "core/error.h"
#include "formats/scene_properties.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double frame_rounding = 0.01;  // [frames] files come with 99.9999 for 100
constexpr int longest_clip = 100000;     // [frames] over an hour: more is a wrong fps or a damaged file
constexpr double most_places = 2e7;      // nodes x frames: half a gigabyte of tracks, seconds

template <class AnyMotion, class Visit>
void for_each_track(AnyMotion& motion, Visit visit) {
  visit(motion.translation);
  visit(motion.rotation);
  visit(motion.scale);
}

std::size_t key_count(const Motion& motion) { return motion.translation.size() + motion.rotation.size() + motion.scale.size(); }

bool varies(const Motion& motion) {
  bool varies = false;
  const auto differs = [](const auto& a, const auto& b) { return !a.isApprox(b, 1e-6); };
  const auto check_vectors = [&](const auto& keys) {
    for (const auto& key : keys) varies |= differs(key.value, keys.front().value);
  };
  check_vectors(motion.translation);
  check_vectors(motion.scale);
  for (const auto& key : motion.rotation) varies |= differs(key.value.coeffs(), motion.rotation.front().value.coeffs());
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
    throw Error(Fault::scene, scene.source, fmt::format("The file has no take \"{}\".", *options.take),
                names.empty() ? "It has no animation at all." : fmt::format("--take can be {}.", fmt::join(names, ", ")));
  return takes;
}

/// A node of the file with the pivots that FBX import puts above it: they are moved by one and the same take.
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

/// Blender writes an animation per object, or per action and object: those of other objects' actions hold two equal keys.
struct Choice {
  const Take* take = nullptr;
  bool varies = false;
  std::size_t keys = 0;
  int moving_takes = 0;
};

Choice choose_take(const std::vector<const Take*>& takes, const std::vector<int>& group) {
  Choice best;
  for (const Take* take : takes) {
    Choice choice{take, false, 0, best.moving_takes};
    for (int node : group) {
      const auto motion = take->motions.find(node);
      if (motion == take->motions.end()) continue;
      choice.keys += key_count(motion->second);
      choice.varies |= varies(motion->second);
    }
    if (choice.keys == 0) continue;
    if (choice.varies) best.moving_takes = ++choice.moving_takes;
    if (!best.take || std::pair(choice.varies, choice.keys) > std::pair(best.varies, best.keys)) best = choice;
  }
  return best;
}

/// Fills scene.motions, times still in seconds; returns the takes that were used.
std::vector<const Take*> merge_takes(SceneNodes& scene, const SceneOptions& options) {
  const auto takes = wanted_takes(scene, options);
  std::vector<const Take*> used;
  std::vector<std::string> contested;
  scene.motions.resize(scene.file.nodes.size());
  for (const std::vector<int>& group : nodes_with_their_pivots(scene.file.nodes)) {
    const Choice choice = choose_take(takes, group);
    if (!choice.take) continue;
    if (std::find(used.begin(), used.end(), choice.take) == used.end()) used.push_back(choice.take);
    const std::string& name = scene.file.nodes[group.front()].name;
    if (choice.moving_takes > 1) contested.push_back(fmt::format("\"{}\" (\"{}\" is used)", name, choice.take->name));
    for (int node : group) {
      const auto motion = choice.take->motions.find(node);
      if (motion != choice.take->motions.end()) scene.motions[node] = motion->second;
    }
  }
  if (!contested.empty())
    scene.warnings.push_back(fmt::format("{} node(s) are moved by several takes, first {}: --take NAME chooses one for all.",
                                         contested.size(), contested.front()));
  scene.origin["takes"] = options.take ? "command line" : fmt::format("{} of {} merged", used.size(), takes.size());
  return used;
}

/// Takes know nodes by their names only.
void warn_of_doubled_names(SceneNodes& scene) {
  std::map<std::string, int> count;
  for (const ImportedNode& node : scene.file.nodes) count[node.name] += !node.pivot;
  for (std::size_t i = 0; i < scene.motions.size(); ++i)
    if (const std::string& name = scene.file.nodes[i].name; key_count(scene.motions[i]) > 0 && count[name] > 1)
      scene.warnings.push_back(fmt::format("{} nodes have the name \"{}\": only the first of them is moved.", count[name], name));
}

void set_fps(SceneNodes& scene, const SceneOptions& options) {
  const auto set = [&](double fps, std::string from) {
    scene.fps = fps;
    scene.origin["fps"] = std::move(from);
  };
  if (options.fps && !(*options.fps > 0 && std::isfinite(*options.fps)))
    throw Error(Fault::scene, scene.source, fmt::format("{} frames per second cannot be meant.", *options.fps),
                "Give a positive number to --fps.");
  if (options.fps) return set(*options.fps, "command line");
  if (scene.file.fps > 0) return set(scene.file.fps, "file");
  for (const ImportedNode& node : scene.file.nodes)
    if (const auto fps = positive_property(scene.source, node, "paper_fps"))
      return set(*fps, fmt::format("paper_fps of \"{}\"", node.name));
  set(24, "default");
  scene.warnings.push_back("The file does not say its frame rate: 24 frames per second are assumed; "
                           "--fps N or a property paper_fps sets it.");
}

struct Span {
  double first = 1e300, last = -1e300;
  void add(double t) { first = std::min(first, t), last = std::max(last, t); }
  bool empty() const { return first > last; }
};

/// A single key says where a node is, not when; importers put it at time 0.
Span key_span(const std::vector<Motion>& motions) {
  Span span;
  for (const Motion& motion : motions)
    for_each_track(motion, [&](const auto& keys) {
      if (keys.size() > 1) span.add(keys.front().time), span.add(keys.back().time);
    });
  return span;
}

double to_frame(double seconds, double fps, int shift) {
  const double frame = seconds * fps + shift, whole = std::round(frame);
  return std::abs(frame - whole) <= frame_rounding ? whole : frame;
}

/// The frame that time 0 of the file falls on.
int first_frame_shift(SceneNodes& scene, const SceneOptions& options, const Span& keys) {
  if (options.start_frame) {
    scene.origin["first_frame"] = "command line";
    // FBX through assimp begins at 0 whenever its clip begins; glTF keeps the time line of the DCC
    const double first_key = scene.file.fbx ? 0 : std::floor(to_frame(keys.first, scene.fps, 0));
    return *options.start_frame - static_cast<int>(first_key);
  }
  scene.origin["first_frame"] = scene.file.fbx ? "default" : "file";
  if (!scene.file.fbx) return 0;
  scene.warnings.push_back("The first frame of an FBX file cannot be read: 1 is assumed; --start-frame N sets it.");
  return 1;
}

void warn_of_keys_between_frames(SceneNodes& scene) {
  std::size_t between = 0, all = 0;
  for (const Motion& motion : scene.motions)
    for_each_track(motion, [&](const auto& keys) {
      if (keys.size() < 2) return;
      all += keys.size();
      for (const auto& key : keys) between += key.time != std::round(key.time);
    });
  if (between > 0)
    scene.warnings.push_back(fmt::format("{} of {} keys lie between whole frames at {:.6g} frames per second: is that the scene's rate "
                                         "(--fps)?", between, all, scene.fps));
}

void set_frames(SceneNodes& scene, const SceneOptions& options, const std::vector<const Take*>& used) {
  const Span keys = key_span(scene.motions);
  if (keys.empty()) {
    scene.first_frame = scene.last_frame = scene.first_clip_frame = scene.last_clip_frame = options.start_frame.value_or(1);
    scene.origin["first_frame"] = options.start_frame ? "command line" : "default";
    return;
  }
  const int shift = std::abs(keys.first) * scene.fps < 1e9 ? first_frame_shift(scene, options, keys) : 0;
  Span clip = keys;
  for (const Take* take : used)
    if (scene.file.fbx) clip.add(0), clip.add(take->seconds);
  const double first = to_frame(clip.first, scene.fps, shift), last = to_frame(clip.last, scene.fps, shift);
  if (!(last - first <= longest_clip) || std::abs(first) > 1e9)
    throw Error(Fault::scene, scene.source, fmt::format("The clip runs from frame {:.6g} to {:.6g}.", first, last),
                "Check --fps, and the range of the export.");
  if ((last - first + 1) * scene.file.nodes.size() > most_places)
    throw Error(Fault::scene, scene.source, fmt::format("The clip has {:.6g} frames of {} nodes: that is too much to follow.", last - first + 1, scene.file.nodes.size()),
                "Export the sheets and handles alone, or a shorter range.");
  for (Motion& motion : scene.motions)
    for_each_track(motion, [&](auto& track) {
      for (auto& key : track) key.time = to_frame(key.time, scene.fps, shift);
    });
  scene.first_clip_frame = static_cast<int>(std::floor(first));
  scene.last_clip_frame = static_cast<int>(std::ceil(last));
  scene.first_frame = static_cast<int>(std::floor(to_frame(keys.first, scene.fps, shift)));
  scene.last_frame = static_cast<int>(std::ceil(to_frame(keys.last, scene.fps, shift)));
  warn_of_keys_between_frames(scene);
}

void set_unit(SceneNodes& scene, const SceneOptions& options) {
  if (options.unit_scale && !(*options.unit_scale > 0 && std::isfinite(*options.unit_scale)))
    throw Error(Fault::scene, scene.source, fmt::format("A unit of {} m cannot be meant.", *options.unit_scale),
                "Give a positive length in metres to --unit-scale.");
  scene.unit = options.unit_scale.value_or(scene.file.unit);
  scene.origin["unit"] = fmt::format("{:.6g} m, {}", scene.unit,
                                     options.unit_scale ? "command line" : scene.file.fbx ? "file" : "glTF");
  scene.origin["up_axis"] = scene.file.up_axis + (scene.file.fbx ? ", file" : ", glTF");
}

template <class Value, class Mix>
Value value_at(const std::vector<Key<Value>>& keys, double frame, Value none, Mix mix) {
  if (keys.empty()) return none;
  const auto after = std::upper_bound(keys.begin(), keys.end(), frame,
                                      [](double f, const Key<Value>& key) { return f < key.time; });
  if (after == keys.begin()) return keys.front().value;
  const auto before = std::prev(after);
  if (after == keys.end() || before->time == frame) return before->value;
  return mix(before->value, after->value, (frame - before->time) / (after->time - before->time));
}

Eigen::Affine3d local_at(const ImportedNode& node, const Motion& motion, int frame) {
  if (key_count(motion) == 0) return node.local;
  const auto line = [](const Vector3d& a, const Vector3d& b, double t) -> Vector3d { return (1 - t) * a + t * b; };
  const auto arc = [](const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double t) { return a.slerp(t, b); };
  Eigen::Affine3d local = Eigen::Affine3d::Identity();
  local.translate(value_at(motion.translation, frame, Vector3d(Vector3d::Zero()), line));
  local.rotate(value_at(motion.rotation, frame, Eigen::Quaterniond::Identity(), arc));
  local.scale(value_at(motion.scale, frame, Vector3d(Vector3d::Ones()), line));
  return local;
}

}  // namespace

SceneNodes scene_nodes(ImportedFile file, std::string source, const SceneOptions& options) {
  SceneNodes scene;
  scene.source = std::move(source);
  scene.file = std::move(file);
  const auto used = merge_takes(scene, options);
  warn_of_doubled_names(scene);
  set_fps(scene, options);
  set_frames(scene, options, used);
  set_unit(scene, options);
  return scene;
}

std::vector<Eigen::Affine3d> world_at(const SceneNodes& scene, int frame) {
  Eigen::Affine3d metres = Eigen::Affine3d::Identity();
  metres.linear() = scene.unit * scene.file.to_z_up;
  std::vector<Eigen::Affine3d> world(scene.file.nodes.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    const ImportedNode& node = scene.file.nodes[i];
    world[i] = (node.parent < 0 ? metres : world[node.parent]) * local_at(node, scene.motions[i], frame);
  }
  return world;
}

Vector3d origin_of(const SceneNodes& scene, const std::vector<Eigen::Affine3d>& world, int node) {
  const auto& nodes = scene.file.nodes;
  int carrier = node;
  for (int above = nodes[node].parent; above >= 0 && nodes[above].offsets_mesh_only;) carrier = above = nodes[above].parent;
  return carrier < 0 ? Vector3d::Zero() : Vector3d(world[carrier].translation());
}

}  // namespace paperbake
