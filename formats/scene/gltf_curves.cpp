#include "formats/scene/gltf_curves.h"

#include "core/model/error.h"
#include "formats/files/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string_view>

namespace paperbake {
namespace {

using gltf::index;
using gltf::list;
using gltf::refuse;
using gltf::text;
using Integers = GltfFile::Integers;

template <class Value>
Value value(const double* n) {
  if constexpr (std::is_same_v<Value, Vector3d>)
    return {n[0], n[1], n[2]};
  else
    return Value(n[3], n[0], n[1], n[2]);
}

/// The factor that makes a key a unit quaternion. The tangents of the key are multiplied by it,
/// too, so that the curve keeps its shape.
double scale_to_unit(const Vector3d&) { return 1; }
double scale_to_unit(const Eigen::Quaterniond& q) { return q.norm() > 1e-9 ? 1 / q.norm() : 0; }

void scale(Vector3d& v, double by) { v *= by; }
void scale(Eigen::Quaterniond& q, double by) { q.coeffs() *= by; }

template <class Value>
Track<Value> track_of(const std::vector<double>& times, const std::vector<double>& numbers,
                      std::size_t width, const std::string& interpolation) {
  Track<Value> track;
  track.interpolation = interpolation == "STEP"          ? Interpolation::step
                        : interpolation == "CUBICSPLINE" ? Interpolation::cubic
                                                         : Interpolation::linear;
  const bool cubic = track.interpolation == Interpolation::cubic;
  const std::size_t each = (cubic ? 3 : 1) * width;
  if (numbers.size() != times.size() * each)
    refuse(
        fmt::format("a sampler has {} times and {} values", times.size(), numbers.size() / width));
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
  for (const std::size_t k : order) {
    const double* n = &numbers[k * each];
    Value p = value<Value>(n + (cubic ? width : 0));
    const double unit = scale_to_unit(p);
    if (unit > 0)
      scale(p, unit);
    else if constexpr (!std::is_same_v<Value, Vector3d>)
      p = Value::Identity();
    track.keys.push_back({times[k], p});
    if (!cubic) continue;
    track.tangents.push_back({value<Value>(n), value<Value>(n + 2 * width)});
    scale(track.tangents.back().in, unit);
    scale(track.tangents.back().out, unit);
  }
  if constexpr (!std::is_same_v<Value, Vector3d>) make_continuous(track);
  return track;
}

/// The node that a channel moves, and which part of its transform.
struct Target {
  std::size_t node;
  std::string path;  // translation, rotation, scale or weights
};

/// The target of a channel; nothing when it is not the transform of a node.
/// source  glTF 2.0, 5.7; KHR_animation_pointer
std::optional<Target> target_of(const Json& channel, std::size_t nodes) {
  const Json target = channel.is_object() ? channel.value("target", Json()) : Json();
  std::string path = text(target, "path", "");
  std::size_t node = 0;
  if (path == "pointer") {
    const Json extensions = target.value("extensions", Json());
    const std::string pointer =
        extensions.is_object()
            ? text(extensions.value("KHR_animation_pointer", Json()), "pointer", "")
            : "";
    const std::string_view nodes_of = "/nodes/";
    const std::size_t slash = pointer.find('/', nodes_of.size());
    if (pointer.rfind(nodes_of, 0) != 0 || slash == std::string::npos) return std::nullopt;
    if (std::from_chars(pointer.data() + nodes_of.size(), pointer.data() + slash, node).ptr !=
        pointer.data() + slash)
      return std::nullopt;
    if (node >= nodes) refuse(fmt::format("an animation moves node {}, of {}", node, nodes));
    path = pointer.substr(slash + 1);
  } else if (target.is_object() && target.contains("node")) {
    node = index(target, "node", nodes);
  } else {
    return std::nullopt;  // target of another extension
  }
  if (path != "translation" && path != "rotation" && path != "scale" && path != "weights")
    return std::nullopt;
  return Target{node, path};
}

/// One track for each blend shape, from the numbers of a sampler, which has the weights of all
/// shapes at each key.
std::vector<Track<Vector3d>> shape_tracks(const std::vector<double>& times,
                                          const std::vector<double>& numbers,
                                          const std::string& interpolation) {
  const std::size_t each = interpolation == "CUBICSPLINE" ? 3 : 1;
  const std::size_t shapes = times.empty() ? 0 : numbers.size() / (each * times.size());
  if (numbers.size() != shapes * each * times.size())
    refuse(fmt::format("a sampler has {} times and {} values", times.size(), numbers.size()));
  std::vector<Track<Vector3d>> tracks;
  for (std::size_t s = 0; s < shapes; ++s) {
    std::vector<double> own;
    for (std::size_t k = 0; k < each * times.size(); ++k)
      own.insert(own.end(), {numbers[k * shapes + s], 0, 0});
    tracks.push_back(track_of<Vector3d>(times, own, 3, interpolation));
  }
  return tracks;
}

/// "key at 0.5 s" or "time of key 2": the first one that contains what is no number; empty: none.
std::string first_key_without_number(const std::vector<double>& times,
                                     const std::vector<double>& numbers) {
  const auto is_bad = [](double n) { return !std::isfinite(n); };
  const auto time = std::find_if(times.begin(), times.end(), is_bad);
  const auto number = std::find_if(numbers.begin(), numbers.end(), is_bad);
  if (time != times.end()) return fmt::format("time of key {}", time - times.begin() + 1);
  if (number == numbers.end()) return "";
  if (times.empty()) return "first key";
  const std::size_t each = std::max<std::size_t>(1, numbers.size() / times.size());
  const std::size_t key = (number - numbers.begin()) / each;
  return fmt::format("key at {:g} s", times[std::min(key, times.size() - 1)]);
}

void read_channel(GltfFile& file, const Json& channel, const Json& samplers, Take& take) {
  const Json& nodes = list(file.json(), "nodes");
  const auto target = target_of(channel, nodes.size());
  if (!target) return;
  const Json& sampler = samplers[index(channel, "sampler", samplers.size())];
  const std::size_t accessors = list(file.json(), "accessors").size(),
                    width = target->path == "rotation"  ? 4
                            : target->path == "weights" ? 1
                                                        : 3;
  const std::vector<double> times =
      file.numbers(index(sampler, "input", accessors), 1, Integers::normalized);
  const std::vector<double> numbers =
      file.numbers(index(sampler, "output", accessors), width, Integers::normalized);
  if (const std::string bad = first_key_without_number(times, numbers); !bad.empty())
    throw Error(ErrorCode::scene,
                fmt::format("node \"{}\"", gltf::name(nodes, target->node, "nodes")),
                fmt::format("Its {} contains a value that is not a number.", bad), export_again);
  const std::string interpolation = text(sampler, "interpolation", "LINEAR");
  if (target->path == "weights") {
    take.shapes[static_cast<int>(target->node)] = shape_tracks(times, numbers, interpolation);
    return;
  }
  Motion& motion = take.motions[static_cast<int>(target->node)];
  if (width == 4)
    motion.rotation = track_of<Eigen::Quaterniond>(times, numbers, width, interpolation);
  else
    (target->path == "scale" ? motion.scale : motion.translation) =
        track_of<Vector3d>(times, numbers, width, interpolation);
  motion.key_times.insert(motion.key_times.end(), times.begin(), times.end());
}

/// Keys the parts of the transform that no channel moves with their value at the node.
void fill_from_node(Motion& motion, const Json& node) {
  Eigen::Affine3d rest = Eigen::Affine3d::Identity();
  Vector3d size = Vector3d::Ones();
  const auto numbers = [&](const char* key, std::size_t count) {
    return gltf::numbers(node, key, count);
  };
  if (const auto m = numbers("matrix", 16); !m.empty()) {
    rest.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
    size = rest.linear().colwise().norm();
    if (rest.linear().determinant() < 0) size = -size;
    for (int k = 0; k < 3; ++k)
      if (size(k) != 0) rest.linear().col(k) /= size(k);
  }
  if (const auto t = numbers("translation", 3); !t.empty())
    rest.translation() = Vector3d(t[0], t[1], t[2]);
  if (const auto s = numbers("scale", 3); !s.empty()) size = Vector3d(s[0], s[1], s[2]);
  Eigen::Quaterniond turn(rest.linear());
  if (const auto r = numbers("rotation", 4); !r.empty())
    turn = Eigen::Quaterniond(r[3], r[0], r[1], r[2]);
  if (!(turn.norm() > 1e-9)) turn.setIdentity();
  if (motion.translation.keys.empty()) motion.translation.keys = {{0, rest.translation()}};
  if (motion.rotation.keys.empty()) motion.rotation.keys = {{0, turn.normalized()}};
  if (motion.scale.keys.empty()) motion.scale.keys = {{0, size}};
}

}  // namespace

std::vector<Take> gltf_takes(GltfFile& file) {
  const Json& nodes = list(file.json(), "nodes");
  std::vector<Take> takes;
  for (const Json& animation : list(file.json(), "animations")) {
    Take take;
    take.name = text(animation, "name", "");
    const Json& samplers = list(animation, "samplers");
    for (const Json& channel : list(animation, "channels"))
      read_channel(file, channel, samplers, take);
    for (auto& [node, motion] : take.motions) {
      fill_from_node(motion, nodes[node]);
      std::sort(motion.key_times.begin(), motion.key_times.end());
      motion.key_times.erase(std::unique(motion.key_times.begin(), motion.key_times.end()),
                             motion.key_times.end());
    }
    takes.push_back(std::move(take));
  }
  return takes;
}

}  // namespace paperbake
