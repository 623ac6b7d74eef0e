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

// The functions `field` define the format once for both directions: with a Writer as stream they
// append a value to the bytes, with a Reader they read it back.
struct Writer {
  static constexpr bool reads = false;
  std::string bytes;
  void raw(const void* value, std::size_t size) {
    bytes.append(static_cast<const char*>(value), size);
  }
};

struct Reader {
  static constexpr bool reads = true;
  std::string_view rest;
  void raw(void* value, std::size_t size) {
    if (size > rest.size()) refuse("the data of the import is cut short");
    if (size > 0) std::memcpy(value, rest.data(), size);
    rest.remove_prefix(size);
  }
};

template <class Stream, class Number>
std::enable_if_t<std::is_arithmetic_v<Number>> field(Stream& stream, Number& value) {
  stream.raw(&value, sizeof value);
}

template <class Stream>
void field(Stream& stream, bool& value) {
  std::uint8_t byte = value;
  field(stream, byte);
  value = byte != 0;
}

/// The number of elements that follow. A Reader refuses more than there are bytes for.
template <class Stream>
std::uint64_t count_field(Stream& stream, std::uint64_t count, std::size_t bytes_each) {
  field(stream, count);
  if constexpr (Stream::reads)
    if (count > stream.rest.size() / bytes_each) refuse("a list is longer than the data");
  return count;
}

template <class Stream>
void field(Stream& stream, std::string& text) {
  text.resize(count_field(stream, text.size(), 1));
  stream.raw(text.data(), text.size());
}

template <class Stream, class Value>
void field(Stream& stream, std::vector<Value>& list) {
  std::uint64_t count = count_field(stream, list.size(), 1);
  if constexpr (Stream::reads)
    for (list.clear(); count > 0; --count) field(stream, list.emplace_back());
  else
    for (Value& value : list) field(stream, value);
}

template <class Stream, class Name, class Value>
void field(Stream& stream, std::map<Name, Value>& map) {
  std::uint64_t count = count_field(stream, map.size(), 1);
  if constexpr (Stream::reads)
    for (map.clear(); count > 0; --count) {
      Name name{};
      field(stream, name);
      field(stream, map[name]);
    }
  else
    for (auto& [name, value] : map) {
      Name copy = name;
      field(stream, copy);
      field(stream, value);
    }
}

template <class Stream, class Scalar, int Rows, int Columns, int Order>
void field(Stream& stream, Eigen::Matrix<Scalar, Rows, Columns, Order>& m) {
  if constexpr (Rows == Eigen::Dynamic)
    m.resize(static_cast<Eigen::Index>(count_field(stream, m.rows(), Columns * sizeof(Scalar))),
             Columns);
  stream.raw(m.data(), m.size() * sizeof(Scalar));
}

template <class Stream>
void field(Stream& stream, AttributeValues& m) {
  auto columns = static_cast<std::uint8_t>(m.cols());
  field(stream, columns);
  if constexpr (Stream::reads)
    if (columns < 1 || columns > AttributeValues::MaxColsAtCompileTime)
      refuse("an attribute does not have one to four numbers for each vertex");
  const std::uint64_t rows = count_field(stream, m.rows(), columns * sizeof(double));
  m.resize(static_cast<Eigen::Index>(rows), columns);
  stream.raw(m.data(), m.size() * sizeof(double));
}

template <class Stream>
void field(Stream& stream, Eigen::Affine3d& t) {
  field(stream, t.matrix());
}

template <class Stream>
void field(Stream& stream, Eigen::Quaterniond& q) {
  field(stream, q.coeffs());
}

template <class Stream, class Value>
void field(Stream& stream, Key<Value>& key) {
  field(stream, key.time);
  field(stream, key.value);
}

template <class Stream, class Value>
void field(Stream& stream, Tangents<Value>& tangents) {
  field(stream, tangents.in);
  field(stream, tangents.out);
}

template <class Stream, class Value>
void field(Stream& stream, Track<Value>& track) {
  std::uint8_t interpolation = static_cast<std::uint8_t>(track.interpolation);
  field(stream, track.keys);
  field(stream, track.tangents);
  field(stream, interpolation);
  track.interpolation = static_cast<Interpolation>(interpolation);
}

template <class Stream>
void field(Stream& stream, Motion& motion) {
  field(stream, motion.translation);
  field(stream, motion.scale);
  field(stream, motion.rotation);
  field(stream, motion.key_times);
}

template <class Stream>
void field(Stream& stream, PropertyValue& value) {
  std::uint8_t kind = static_cast<std::uint8_t>(value.index());
  field(stream, kind);
  if constexpr (Stream::reads) {
    if (kind == 0)
      value.template emplace<0>();
    else if (kind == 1)
      value.template emplace<1>();
    else
      value.template emplace<2>();
  }
  std::visit([&](auto& alternative) { field(stream, alternative); }, value);
}

template <class Stream>
void field(Stream& stream, ImportedNode& n) {
  field(stream, n.name);
  field(stream, n.parent);
  field(stream, n.local);
  field(stream, n.scale);
  field(stream, n.own_scale);
  field(stream, n.scale_from);
  field(stream, n.pivot);
  field(stream, n.offsets_mesh_only);
  field(stream, n.meshes);
  field(stream, n.properties);
}

template <class Stream>
void field(Stream& stream, AuthoredAttribute& a) {
  auto kind = static_cast<std::uint8_t>(a.kind);
  field(stream, a.name);
  field(stream, kind);
  field(stream, a.values);
  a.kind = static_cast<AttributeKind>(kind);
}

template <class Stream>
void field(Stream& stream, Skin& s) {
  field(stream, s.bones);
  field(stream, s.to_bone);
  field(stream, s.influences);
  field(stream, s.weights);
}

template <class Stream>
void field(Stream& stream, ImportedMesh& m) {
  field(stream, m.x);
  field(stream, m.attributes);
  field(stream, m.triangles);
  field(stream, m.materials);
  field(stream, m.material_of);
  field(stream, m.creases);
  field(stream, m.deformed);
  field(stream, m.not_followed);
  field(stream, m.skin);
  field(stream, m.targets);
  field(stream, m.target_weights);
}

template <class Stream>
void field(Stream& stream, Take& t) {
  field(stream, t.name);
  field(stream, t.begin);
  field(stream, t.end);
  field(stream, t.motions);
  field(stream, t.shapes);
}

template <class Stream>
void field(Stream& stream, ImportedFile& f) {
  field(stream, f.fbx);
  field(stream, f.start_lost);
  field(stream, f.reader);
  field(stream, f.warnings);
  field(stream, f.nodes);
  field(stream, f.meshes);
  field(stream, f.takes);
  field(stream, f.unit);
  field(stream, f.fps);
  field(stream, f.to_z_up);
  field(stream, f.up_axis);
}

template <class Stream>
void field(Stream& stream, ImportResult& r) {
  field(stream, r.file);
  field(stream, r.place);
  field(stream, r.cause);
  field(stream, r.remedy);
}

void check_times(double before, double time) {
  if (!std::isfinite(time) || time < before) refuse("a key is not a number, or is out of order");
}

template <class Value>
void check_track(const Track<Value>& track) {
  const bool cubic = track.interpolation == Interpolation::cubic;
  if (track.interpolation > Interpolation::cubic ||
      track.tangents.size() != (cubic ? track.keys.size() : 0))
    refuse("a track does not have one tangent for each key");
  double before = -std::numeric_limits<double>::infinity();
  for (const Key<Value>& key : track.keys) {
    check_times(before, key.time);
    before = key.time;
    if constexpr (std::is_same_v<Value, Vector3d>) {
      if (!key.value.allFinite()) refuse("a key is not a number");
    } else if (!(std::abs(key.value.norm() - 1) < 1e-6)) {
      refuse("a key is not a rotation");
    }
  }
  for (const Tangents<Value>& tangents : track.tangents) {
    bool finite;
    if constexpr (std::is_same_v<Value, Vector3d>)
      finite = tangents.in.allFinite() && tangents.out.allFinite();
    else
      finite = tangents.in.coeffs().allFinite() && tangents.out.coeffs().allFinite();
    if (!finite) refuse("a tangent is not a number");
  }
}

void check_deformation(const ImportedMesh& mesh, std::size_t nodes) {
  const Skin& skin = mesh.skin;
  if (skin.to_bone.size() != skin.bones.size() || skin.weights.size() != skin.influences.rows() ||
      !skin.weights.allFinite())
    refuse("a skin does not have one transform for each bone");
  for (const int bone : skin.bones)
    if (bone < 0 || static_cast<std::size_t>(bone) >= nodes)
      refuse("a skin has a bone that does not exist");
  for (const Eigen::Affine3d& to_bone : skin.to_bone)
    if (!to_bone.matrix().allFinite()) refuse("a skin is not a number");
  for (Eigen::Index i = 0; i < skin.influences.rows(); ++i)
    if (skin.influences(i, 0) < 0 || skin.influences(i, 0) >= mesh.x.rows() ||
        skin.influences(i, 1) < 0 ||
        (!skin.bones.empty() && skin.influences(i, 1) >= static_cast<int>(skin.bones.size())))
      refuse("a skin moves a vertex that does not exist");
  if (mesh.target_weights.size() != mesh.targets.size()) refuse("a blend shape has no weight");
  for (const Points3& target : mesh.targets)
    if (target.rows() != mesh.x.rows() || !target.allFinite())
      refuse("a blend shape does not have all vertices");
  for (const double weight : mesh.target_weights)
    if (!std::isfinite(weight)) refuse("the weight of a blend shape is not a number");
}

void check_attributes(const ImportedMesh& mesh) {
  AttributeKind before = AttributeKind::uv;
  for (const AuthoredAttribute& a : mesh.attributes) {
    const Eigen::Index width = a.values.cols();
    if (a.kind > AttributeKind::number || (a.kind == AttributeKind::uv && width != 2) ||
        (a.kind == AttributeKind::colour && width < 3))
      refuse("an attribute is neither a uv set nor a colour nor numbers");
    if (a.kind == AttributeKind::uv && before != AttributeKind::uv)
      refuse("a uv set stands after other attributes");
    if (a.values.rows() != mesh.x.rows())
      refuse("a mesh does not have one value of an attribute for each vertex");
    if (!a.values.allFinite()) refuse("a value of an attribute is not a number");
    before = a.kind;
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
      refuse("a transform is not a number");
    if (node.scale_from != -1 && !below(node.scale_from, i))
      refuse("a node stands before the node that scales it");
    for (const int mesh : node.meshes)
      if (!below(mesh, file.meshes.size())) refuse("a node has a mesh that does not exist");
  }
  for (const ImportedMesh& mesh : file.meshes) {
    check_attributes(mesh);
    if (!mesh.x.allFinite()) refuse("a vertex is not a number");
    if (!mesh.material_of.empty() &&
        mesh.material_of.size() != static_cast<std::size_t>(mesh.triangles.rows()))
      refuse("a mesh does not have one material for each face");
    for (const int material : mesh.material_of)
      if (material != -1 && !below(material, mesh.materials.size()))
        refuse("a face has a material that does not exist");
    if (mesh.triangles.size() > 0 &&
        (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.x.rows()))
      refuse("a face has a vertex that does not exist");
    if (mesh.creases.size() > 0 &&
        (mesh.creases.minCoeff() < 0 || mesh.creases.maxCoeff() >= mesh.x.rows()))
      refuse("an edge has a vertex that does not exist");
    check_deformation(mesh, file.nodes.size());
  }
  for (const Take& take : file.takes) {
    if (!std::isfinite(take.begin) || !std::isfinite(take.end))
      refuse("the length of a take is not a number");
    for (const auto& [node, tracks] : take.shapes) {
      if (!below(node, file.nodes.size())) refuse("a take moves a node that does not exist");
      for (const Track<Vector3d>& track : tracks) check_track(track);
    }
    for (const auto& [node, motion] : take.motions) {
      if (!below(node, file.nodes.size())) refuse("a take moves a node that does not exist");
      check_track(motion.translation);
      check_track(motion.scale);
      check_track(motion.rotation);
      for (std::size_t k = 0; k < motion.key_times.size(); ++k)
        check_times(k > 0 ? motion.key_times[k - 1] : motion.key_times[k], motion.key_times[k]);
    }
  }
  if (!(file.unit > 0) || !std::isfinite(file.unit) || !(file.fps >= 0) ||
      !std::isfinite(file.fps) || !file.to_z_up.allFinite())
    refuse("unit, frame rate or axes are not numbers");
}

}  // namespace

std::string serialize(ImportResult result) {
  Writer to;
  field(to, result);
  return std::move(to.bytes);
}

ImportResult deserialize(std::string_view bytes) {
  Reader from{bytes};
  ImportResult result;
  field(from, result);
  check(result.file);
  return result;
}

}  // namespace paperbake
