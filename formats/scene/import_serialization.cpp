#include "formats/scene/import_serialization.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

namespace paperbake {
namespace {

[[noreturn]] void refuse(const char* what) { throw std::runtime_error(what); }

/// The two ways of a message: what `pass` is given, Write appends and Read brings back.
struct Write {
  static constexpr bool reads = false;
  std::string bytes;
  void raw(const void* value, std::size_t size) {
    bytes.append(static_cast<const char*>(value), size);
  }
};

struct Read {
  static constexpr bool reads = true;
  std::string_view rest;
  void raw(void* value, std::size_t size) {
    if (size > rest.size()) refuse("the message is cut short");
    if (size > 0) std::memcpy(value, rest.data(), size);
    rest.remove_prefix(size);
  }
};

template <class Way, class Number>
std::enable_if_t<std::is_arithmetic_v<Number>> pass(Way& way, Number& value) {
  way.raw(&value, sizeof value);
}

template <class Way>
void pass(Way& way, bool& value) {
  std::uint8_t byte = value;
  pass(way, byte);
  value = byte != 0;
}

/// How many follow; when read, no more than there are bytes for.
template <class Way>
std::uint64_t pass_count(Way& way, std::uint64_t count, std::size_t bytes_each) {
  pass(way, count);
  if constexpr (Way::reads)
    if (count > way.rest.size() / bytes_each) refuse("a list is longer than the message");
  return count;
}

template <class Way>
void pass(Way& way, std::string& text) {
  text.resize(pass_count(way, text.size(), 1));
  way.raw(text.data(), text.size());
}

template <class Way, class Value>
void pass(Way& way, std::vector<Value>& list) {
  std::uint64_t count = pass_count(way, list.size(), 1);
  if constexpr (Way::reads)
    for (list.clear(); count > 0; --count) pass(way, list.emplace_back());
  else
    for (Value& value : list) pass(way, value);
}

template <class Way, class Name, class Value>
void pass(Way& way, std::map<Name, Value>& map) {
  std::uint64_t count = pass_count(way, map.size(), 1);
  if constexpr (Way::reads)
    for (map.clear(); count > 0; --count) {
      Name name{};
      pass(way, name);
      pass(way, map[name]);
    }
  else
    for (auto& [name, value] : map) {
      Name copy = name;
      pass(way, copy), pass(way, value);
    }
}

template <class Way, class Scalar, int Rows, int Columns, int Order>
void pass(Way& way, Eigen::Matrix<Scalar, Rows, Columns, Order>& m) {
  if constexpr (Rows == Eigen::Dynamic)
    m.resize(static_cast<Eigen::Index>(pass_count(way, m.rows(), Columns * sizeof(Scalar))),
             Columns);
  way.raw(m.data(), m.size() * sizeof(Scalar));
}

template <class Way>
void pass(Way& way, Eigen::Affine3d& t) {
  pass(way, t.matrix());
}

template <class Way>
void pass(Way& way, Eigen::Quaterniond& q) {
  pass(way, q.coeffs());
}

template <class Way, class Value>
void pass(Way& way, Key<Value>& key) {
  pass(way, key.time), pass(way, key.value);
}

template <class Way, class Value>
void pass(Way& way, Slopes<Value>& slopes) {
  pass(way, slopes.in), pass(way, slopes.out);
}

template <class Way, class Value>
void pass(Way& way, Track<Value>& track) {
  std::uint8_t between = static_cast<std::uint8_t>(track.between);
  pass(way, track.keys), pass(way, track.slopes), pass(way, between);
  track.between = static_cast<Between>(between);
}

template <class Way>
void pass(Way& way, Motion& motion) {
  pass(way, motion.translation), pass(way, motion.scale), pass(way, motion.rotation),
      pass(way, motion.key_times);
}

template <class Way>
void pass(Way& way, PropertyValue& value) {
  std::uint8_t kind = static_cast<std::uint8_t>(value.index());
  pass(way, kind);
  if constexpr (Way::reads) {
    if (kind == 0)
      value.template emplace<0>();
    else if (kind == 1)
      value.template emplace<1>();
    else
      value.template emplace<2>();
  }
  std::visit([&](auto& held) { pass(way, held); }, value);
}

template <class Way>
void pass(Way& way, ImportedNode& n) {
  pass(way, n.name), pass(way, n.parent), pass(way, n.local), pass(way, n.scale),
      pass(way, n.own_scale), pass(way, n.scale_from), pass(way, n.pivot),
      pass(way, n.offsets_mesh_only), pass(way, n.meshes), pass(way, n.properties);
}

template <class Way>
void pass(Way& way, ImportedMesh& m) {
  pass(way, m.x), pass(way, m.uv), pass(way, m.triangles), pass(way, m.creases),
      pass(way, m.deformed);
}

template <class Way>
void pass(Way& way, Take& t) {
  pass(way, t.name), pass(way, t.begin), pass(way, t.end), pass(way, t.motions);
}

template <class Way>
void pass(Way& way, ImportedFile& f) {
  pass(way, f.fbx), pass(way, f.start_lost), pass(way, f.reader), pass(way, f.warnings),
      pass(way, f.nodes), pass(way, f.meshes), pass(way, f.takes), pass(way, f.unit),
      pass(way, f.fps), pass(way, f.to_z_up), pass(way, f.up_axis);
}

template <class Way>
void pass(Way& way, SceneMessage& m) {
  pass(way, m.file), pass(way, m.place), pass(way, m.cause), pass(way, m.remedy);
}

void check_times(double before, double time) {
  if (!std::isfinite(time) || time < before) refuse("a key is no number or out of order");
}

template <class Value>
void check_track(const Track<Value>& track) {
  const bool cubic = track.between == Between::cubic;
  if (track.between > Between::cubic || track.slopes.size() != (cubic ? track.keys.size() : 0))
    refuse("a track does not have a slope for each key");
  double before = -std::numeric_limits<double>::infinity();
  for (const Key<Value>& key : track.keys) {
    check_times(before, key.time), before = key.time;
    if constexpr (std::is_same_v<Value, Vector3d>) {
      if (!key.value.allFinite()) refuse("a key is no number");
    } else if (!(std::abs(key.value.norm() - 1) < 1e-6)) {
      refuse("a key is no rotation");
    }
  }
  for (const Slopes<Value>& slopes : track.slopes) {
    bool finite;
    if constexpr (std::is_same_v<Value, Vector3d>)
      finite = slopes.in.allFinite() && slopes.out.allFinite();
    else
      finite = slopes.in.coeffs().allFinite() && slopes.out.coeffs().allFinite();
    if (!finite) refuse("a slope is no number");
  }
}

void check(const ImportedFile& file) {
  const auto below = [](int i, std::size_t count) {
    return i >= 0 && static_cast<std::size_t>(i) < count;
  };
  for (std::size_t i = 0; i < file.nodes.size(); ++i) {
    const ImportedNode& node = file.nodes[i];
    if (node.parent != -1 && !below(node.parent, i)) refuse("a node stands before its parent");
    if (!node.local.matrix().allFinite() || !node.scale.allFinite())
      refuse("a transform is no number");
    if (node.scale_from != -1 && !below(node.scale_from, i))
      refuse("a node stands before what scales it");
    for (const int mesh : node.meshes)
      if (!below(mesh, file.meshes.size())) refuse("a node has a mesh that is not there");
  }
  for (const ImportedMesh& mesh : file.meshes) {
    if (mesh.uv.rows() != 0 && mesh.uv.rows() != mesh.x.rows())
      refuse("a mesh does not have one uv for each vertex");
    if (!mesh.x.allFinite() || !mesh.uv.allFinite()) refuse("a vertex is no number");
    if (mesh.triangles.size() > 0 &&
        (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.x.rows()))
      refuse("a face has a vertex that is not there");
    if (mesh.creases.size() > 0 &&
        (mesh.creases.minCoeff() < 0 || mesh.creases.maxCoeff() >= mesh.x.rows()))
      refuse("an edge has a vertex that is not there");
  }
  for (const Take& take : file.takes) {
    if (!std::isfinite(take.begin) || !std::isfinite(take.end))
      refuse("a take's length is no number");
    for (const auto& [node, motion] : take.motions) {
      if (!below(node, file.nodes.size())) refuse("a take moves a node that is not there");
      check_track(motion.translation), check_track(motion.scale), check_track(motion.rotation);
      for (std::size_t k = 0; k < motion.key_times.size(); ++k)
        check_times(k > 0 ? motion.key_times[k - 1] : motion.key_times[k], motion.key_times[k]);
    }
  }
  if (!(file.unit > 0) || !std::isfinite(file.unit) || !(file.fps >= 0) ||
      !std::isfinite(file.fps) || !file.to_z_up.allFinite())
    refuse("unit, rate or axes are no numbers");
}

}  // namespace

std::string bytes_of(SceneMessage message) {
  Write to;
  pass(to, message);
  return std::move(to.bytes);
}

SceneMessage message_of(std::string_view bytes) {
  Read from{bytes};
  SceneMessage message;
  pass(from, message);
  check(message.file);
  return message;
}

}  // namespace paperbake
