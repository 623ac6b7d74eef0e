#include "formats/scene/import_serialization.h"

#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace paperbake {

static void archive(Serializer& a, Eigen::Affine3d& t) { a(t.matrix()); }
static void archive(Serializer& a, Eigen::Quaterniond& q) { a(q.coeffs()); }

template <class Value>
static void archive(Serializer& a, Key<Value>& key) {
  a(key.time, key.value);
}

template <class Value>
static void archive(Serializer& a, Tangents<Value>& tangents) {
  a(tangents.in, tangents.out);
}

template <class Value>
static void archive(Serializer& a, Track<Value>& track) {
  a(track.keys, track.tangents, track.interpolation);
}

static void archive(Serializer& a, Motion& motion) {
  a(motion.translation, motion.scale, motion.rotation, motion.key_times);
}

static void archive(Serializer& a, PropertyValue& value) {
  auto kind = static_cast<std::uint8_t>(value.index());
  a(kind);
  if (a.reads() && kind == 0) value.emplace<double>();
  if (a.reads() && kind == 1) value.emplace<std::string>();
  if (a.reads() && kind == 2) value.emplace<std::vector<double>>();
  a.require(kind == value.index());
  std::visit([&](auto& alternative) { a(alternative); }, value);
}

static void archive(Serializer& a, ImportedNode& n) {
  a(n.name, n.parent, n.local, n.scale, n.own_scale, n.scale_from, n.pivot, n.offsets_mesh_only,
    n.meshes, n.properties);
}

static void archive(Serializer& a, AuthoredAttribute& attribute) {
  auto kind = static_cast<std::uint8_t>(attribute.kind);
  a(attribute.name, kind, attribute.values);
  attribute.kind = static_cast<AttributeKind>(kind);
}

static void archive(Serializer& a, Skin& s) { a(s.bones, s.to_bone, s.influences, s.weights); }

static void archive(Serializer& a, ImportedMesh& m) {
  a(m.x, m.attributes, m.triangles, m.materials, m.material_of, m.creases, m.deformed,
    m.not_followed, m.skin, m.targets, m.target_weights);
}

static void archive(Serializer& a, Take& t) { a(t.name, t.begin, t.end, t.motions, t.shapes); }

static void archive(Serializer& a, ImportedFile& f) {
  a(f.fbx, f.start_lost, f.reader, f.warnings, f.nodes, f.meshes, f.takes, f.unit, f.fps, f.to_z_up,
    f.up_axis);
}

static void archive(Serializer& a, ImportResult& r) { a(r.file, r.place, r.cause, r.remedy); }

namespace {

[[noreturn]] void refuse(const char* what) { throw Damage(what); }

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
  Serializer to;
  to(result);
  return to.bytes();
}

ImportResult deserialize(std::string_view bytes) {
  Serializer from(bytes);
  ImportResult result;
  from(result);
  from.end();
  check(result.file);
  return result;
}

}  // namespace paperbake
