#include "formats/scene/scene_gltf.h"

#include "core/model/error.h"
#include "formats/files/json.h"
#include "formats/scene/gltf_curves.h"
#include "formats/scene/gltf_file.h"
#include "formats/scene/scene_properties.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace paperbake {
namespace {

using gltf::index;
using gltf::list;
using gltf::refuse;
using gltf::whole;
using Integers = GltfFile::Integers;

std::optional<PropertyValue> value_of(const Json& extra) {
  if (extra.is_boolean()) return extra.get<bool>() ? 1.0 : 0.0;
  if (extra.is_number()) return extra.get<double>();
  if (extra.is_string()) return text_or_list(extra.get<std::string>());
  if (!extra.is_array() ||
      !std::all_of(extra.begin(), extra.end(), [](const Json& n) { return n.is_number(); }))
    return std::nullopt;
  return extra.get<std::vector<double>>();
}

/// Adds custom properties. To be called for the node first, then for its mesh: those added first
/// win.
void add_properties(const Json& object, ImportedNode& node) {
  const auto extras = object.find("extras");
  if (extras == object.end() || !extras->is_object()) return;
  for (const auto& [key, extra] : extras->items())
    if (const auto value = value_of(extra)) node.properties.emplace(key, *value);
}

/// The vertex indices of all faces, lines or points of a primitive.
std::vector<int> corners_of(GltfFile& file, const Json& primitive, Eigen::Index vertices) {
  std::vector<int> corners;
  if (primitive.contains("indices")) {
    for (const std::size_t i :
         file.indices(index(primitive, "indices", list(file.json(), "accessors").size()))) {
      if (i >= static_cast<std::size_t>(vertices))
        refuse("a face has a vertex that does not exist");
      corners.push_back(static_cast<int>(i));
    }
  } else {
    for (int i = 0; i < vertices; ++i) corners.push_back(i);
  }
  return corners;
}

/// Triangles from the modes triangles, triangle strip and triangle fan.
/// source  glTF 2.0, section 3.7.2.1
std::vector<std::array<int, 3>> triangles_of(const std::vector<int>& corners, std::size_t mode) {
  constexpr std::size_t alone = 4, strip = 5, fan = 6;
  std::vector<std::array<int, 3>> triangles;
  if (mode == alone)
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
      triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  for (std::size_t i = 0; (mode == strip || mode == fan) && i + 2 < corners.size(); ++i) {
    const std::array<int, 3> t =
        mode == fan ? std::array{corners[i + 1], corners[i + 2], corners[0]}
                    : std::array{corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]};
    // strips are joined by degenerate triangles
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  return triangles;
}

/// Edges from the modes lines, line loop and line strip.
Edges lines_of(const std::vector<int>& corners, std::size_t mode) {
  constexpr std::size_t alone = 1, ring = 2, strip = 3;
  std::vector<int> ends;
  if (mode == alone) ends.assign(corners.begin(), corners.end() - corners.size() % 2);
  for (std::size_t i = 0; (mode == ring || mode == strip) && i + 1 < corners.size(); ++i) {
    ends.push_back(corners[i]);
    ends.push_back(corners[i + 1]);
  }
  if (mode == ring && corners.size() > 2) {
    ends.push_back(corners.back());
    ends.push_back(corners.front());
  }
  return Eigen::Map<Edges>(ends.data(), static_cast<Eigen::Index>(ends.size() / 2), 2);
}

/// Converts a glTF file to an ImportedFile.
struct GltfConverter {
  GltfFile& file;
  const Json& nodes;
  ImportedFile result;
  std::map<int, int> node_index;                         // index in the file -> index in result
  std::map<std::size_t, std::vector<int>> mesh_indices;  // mesh in the file -> meshes in result
  // meshes of result that have bones, and their skin in the file
  std::vector<std::pair<int, std::size_t>> skinned = {};

  void add_nodes(const std::vector<int>& roots);
  void add_node(int i, int parent);
  const std::vector<int>& mesh(std::size_t i);
  ImportedMesh primitive(const Json& primitive, const std::string& place);
  std::vector<int> own_copy(const std::vector<int>& meshes, const Json& node);
  void find_bones();
};

/// The vertices that bones move: all sets of four influences for each vertex.
void read_influences(GltfFile& file, const Json& attributes, ImportedMesh& mesh) {
  const std::size_t accessors = list(file.json(), "accessors").size();
  std::vector<int> pairs;
  std::vector<double> weights;
  for (int set = 0;; ++set) {
    const std::string joints = fmt::format("JOINTS_{}", set), by = fmt::format("WEIGHTS_{}", set);
    if (!attributes.contains(joints) || !attributes.contains(by)) break;
    const std::vector<double> bone = file.numbers(index(attributes, joints.c_str(), accessors), 4,
                                                  Integers::as_flagged),
                              weight = file.numbers(index(attributes, by.c_str(), accessors), 4,
                                                    Integers::as_flagged);
    if (bone.size() != 4 * static_cast<std::size_t>(mesh.x.rows()) || weight.size() != bone.size())
      refuse("a mesh does not have the bones of each vertex");
    for (std::size_t i = 0; i < bone.size(); ++i)
      if (weight[i] > 0) {
        pairs.push_back(static_cast<int>(i / 4));
        pairs.push_back(static_cast<int>(bone[i]));
        weights.push_back(weight[i]);
      }
  }
  const auto count = static_cast<Eigen::Index>(weights.size());
  mesh.skin.influences =
      Eigen::Map<Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor>>(pairs.data(), count, 2);
  mesh.skin.weights = Eigen::Map<Eigen::VectorXd>(weights.data(), count);
}

void read_targets(GltfFile& file, const Json& primitive, ImportedMesh& mesh) {
  const std::size_t accessors = list(file.json(), "accessors").size();
  for (const Json& target : list(primitive, "targets")) {
    Points3& moves = mesh.targets.emplace_back(Points3::Zero(mesh.x.rows(), 3));
    mesh.target_weights.push_back(0);
    if (!target.contains("POSITION")) continue;
    const std::vector<double> x =
        file.numbers(index(target, "POSITION", accessors), 3, Integers::as_flagged);
    if (static_cast<Eigen::Index>(x.size()) != mesh.x.size())
      refuse("a blend shape does not have all vertices");
    moves = Eigen::Map<const Points3>(x.data(), mesh.x.rows(), 3);
  }
}

/// How many numbers an element of an accessor has; 0 for a matrix.
std::size_t width_of(const Json& accessor) {
  const std::string type = gltf::text(accessor, "type", "");
  if (type == "SCALAR") return 1;
  const bool vector = type.size() == 4 && type.rfind("VEC", 0) == 0;
  return vector && '2' <= type[3] && type[3] <= '4' ? static_cast<std::size_t>(type[3] - '0') : 0;
}

/// Reads the attribute that the file calls `semantic`; throws what it is refused with.
/// width  numbers of a vertex
AuthoredAttribute read_attribute(GltfFile& file, const Json& attributes,
                                 const std::string& semantic, std::size_t width,
                                 AttributeKind kind) {
  const std::vector<double> numbers = file.numbers(
      index(attributes, semantic.c_str(), list(file.json(), "accessors").size()), width,
      kind == AttributeKind::colour ? Integers::normalized : Integers::as_flagged);
  AuthoredAttribute attribute{semantic, kind, {}};
  attribute.values = Eigen::Map<const AttributeValues>(
      numbers.data(), static_cast<Eigen::Index>(numbers.size() / width),
      static_cast<Eigen::Index>(width));
  return attribute;
}

/// The uv sets, the colours, and what the artist has added under a name that begins with `_`. glTF
/// has no names for the first two: these are those that Blender gives.
/// left_out  gets a sentence for each that cannot be read
std::vector<AuthoredAttribute> read_attributes(GltfFile& file, const Json& attributes,
                                               Eigen::Index vertices,
                                               std::vector<std::string>& left_out) {
  const Json& accessors = list(file.json(), "accessors");
  const auto width = [&](const std::string& semantic) {
    return width_of(accessors[index(attributes, semantic.c_str(), accessors.size())]);
  };
  const auto numbered = [](const char* name, int n) {
    return n == 0 ? std::string(name) : fmt::format("{}.{:03}", name, n);
  };
  std::vector<AuthoredAttribute> found;
  for (int n = 0; attributes.contains(fmt::format("TEXCOORD_{}", n)); ++n) {
    found.push_back(
        read_attribute(file, attributes, fmt::format("TEXCOORD_{}", n), 2, AttributeKind::uv));
    found.back().name = numbered("UVMap", n);
    found.back().values.col(1) = 1 - found.back().values.col(1).array();  // v counts downwards
  }
  // what is damaged here is left out: a scene may be simulated without it
  const auto add = [&](const std::string& semantic, const std::string& name, AttributeKind kind) {
    try {
      const std::size_t numbers = width(semantic);
      if (numbers == 0 || (kind == AttributeKind::colour && numbers < 3))
        refuse("it has another number of values");
      AuthoredAttribute attribute = read_attribute(file, attributes, semantic, numbers, kind);
      if (attribute.values.rows() != vertices) refuse("it does not have a value for each vertex");
      if (!attribute.values.allFinite()) refuse("a value is not a number");
      found.push_back(std::move(attribute));
      found.back().name = name;
    } catch (const Damage& damage) {
      left_out.push_back(fmt::format("{} is left out: {}.", semantic, damage.what()));
    } catch (const Error& error) {  // its part of the file is missing
      left_out.push_back(fmt::format("{} is left out: {} {}", semantic, error.cause, error.remedy));
    }
  };
  for (int n = 0; attributes.contains(fmt::format("COLOR_{}", n)); ++n)
    add(fmt::format("COLOR_{}", n), numbered("Color", n), AttributeKind::colour);
  for (const auto& [semantic, accessor] : attributes.items())
    if (semantic.size() > 1 && semantic[0] == '_' && width(semantic) > 0)
      add(semantic, semantic.substr(1), AttributeKind::number);
  return found;
}

ImportedMesh GltfConverter::primitive(const Json& primitive, const std::string& place) {
  const Json& accessors = list(file.json(), "accessors");
  const Json attributes = primitive.value("attributes", Json());
  const auto numbers = [&](const char* attribute, std::size_t width) {
    const auto found = attributes.find(attribute);
    return found == attributes.end() ? std::vector<double>()
                                     : file.numbers(index(attributes, attribute, accessors.size()),
                                                    width, Integers::as_flagged);
  };
  if (primitive.value("extensions", Json::object()).contains("KHR_draco_mesh_compression") &&
      attributes.contains("POSITION") &&
      !accessors[index(attributes, "POSITION", accessors.size())].contains("bufferView"))
    throw Error(ErrorCode::scene, place, "The mesh is compressed (KHR_draco_mesh_compression).",
                "Export it without compression.");
  const std::vector<double> x = numbers("POSITION", 3);
  ImportedMesh copy;
  copy.x = Eigen::Map<const Points3>(x.data(), static_cast<Eigen::Index>(x.size() / 3), 3);
  std::vector<std::string> left_out;
  copy.attributes = read_attributes(file, attributes, copy.x.rows(), left_out);
  for (const std::string& sentence : left_out)
    result.warnings.push_back(fmt::format("{}: {}", place, sentence));
  bool finite = copy.x.allFinite();
  for (const AuthoredAttribute& attribute : copy.attributes) {
    if (attribute.values.rows() != copy.x.rows())
      refuse(fmt::format("a mesh does not have one value of {} for each vertex", attribute.name));
    finite = finite && attribute.values.allFinite();
  }
  if (!finite)
    throw Error(ErrorCode::scene, place, "A vertex contains a value that is not a number.",
                export_again);
  const std::vector<int> corners = corners_of(file, primitive, copy.x.rows());
  const std::size_t mode = whole(primitive, "mode", 4);
  const auto triangles = triangles_of(corners, mode);
  copy.creases = lines_of(corners, mode);
  copy.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    copy.triangles.row(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1],
        triangles[t][2];
  copy.deformed = !list(primitive, "targets").empty();
  if (const Json& materials = list(file.json(), "materials"); primitive.contains("material")) {
    const std::size_t i = index(primitive, "material", materials.size());
    copy.materials = {gltf::name(materials, i, "materials")};
    copy.material_of.assign(triangles.size(), 0);
  }
  read_targets(file, primitive, copy);
  read_influences(file, attributes, copy);
  return copy;
}

const std::vector<int>& GltfConverter::mesh(std::size_t i) {
  const auto known = mesh_indices.find(i);
  if (known != mesh_indices.end()) return known->second;
  const Json& all = list(file.json(), "meshes");
  std::vector<int>& copied = mesh_indices[i];
  for (const Json& p : list(all[i], "primitives")) {
    copied.push_back(static_cast<int>(result.meshes.size()));
    result.meshes.push_back(primitive(p, fmt::format("mesh \"{}\"", gltf::name(all, i, "meshes"))));
    ImportedMesh& made = result.meshes.back();
    if (const auto w = gltf::numbers(all[i], "weights", made.targets.size()); !w.empty())
      made.target_weights = w;
  }
  return copied;
}

void GltfConverter::add_node(int i, int parent) {
  const Json& node = nodes[i];
  ImportedNode copy;
  copy.name = gltf::name(nodes, i, "nodes");
  copy.parent = parent;
  if (const auto m = gltf::numbers(node, "matrix", 16); !m.empty())
    copy.local.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
  if (const auto t = gltf::numbers(node, "translation", 3); !t.empty())
    copy.local.translation() = Vector3d(t[0], t[1], t[2]);
  if (const auto r = gltf::numbers(node, "rotation", 4); !r.empty()) {
    const Eigen::Quaterniond turn(r[3], r[0], r[1], r[2]);
    if (turn.norm() > 1e-9) copy.local.linear() = turn.normalized().toRotationMatrix();
  }
  if (const auto s = gltf::numbers(node, "scale", 3); !s.empty())
    copy.scale = Vector3d(s[0], s[1], s[2]);
  for (const char* part : {"matrix", "translation", "rotation", "scale"})
    for (const Json& n : list(node, part))
      if (!n.is_number())
        throw Error(ErrorCode::scene, fmt::format("node \"{}\"", copy.name),
                    "Its transform contains a value that is not a number.", export_again);
  add_properties(node, copy);
  if (node.contains("mesh")) {
    const Json& all = list(file.json(), "meshes");
    const std::size_t m = index(node, "mesh", all.size());
    copy.meshes = mesh(m);
    add_properties(all[m], copy);
    if (node.contains("skin") || node.contains("weights"))
      copy.meshes = own_copy(copy.meshes, node);
  }
  node_index.emplace(i, static_cast<int>(result.nodes.size()));
  result.nodes.push_back(std::move(copy));
}

/// Copies of meshes for a node that has bones, or its own weights of blend shapes.
std::vector<int> GltfConverter::own_copy(const std::vector<int>& meshes, const Json& node) {
  std::vector<int> copies;
  for (const int m : meshes) {
    copies.push_back(static_cast<int>(result.meshes.size()));
    result.meshes.push_back(ImportedMesh(result.meshes[m]));
    ImportedMesh& copy = result.meshes.back();
    if (const auto w = gltf::numbers(node, "weights", copy.targets.size()); !w.empty())
      copy.target_weights = w;
    if (!node.contains("skin")) continue;
    copy.deformed = true;
    skinned.emplace_back(copies.back(), index(node, "skin", list(file.json(), "skins").size()));
  }
  return copies;
}

/// Sets the bones of the meshes that have some. To be called when all nodes have been added.
void GltfConverter::find_bones() {
  const Json &skins = list(file.json(), "skins"), &accessors = list(file.json(), "accessors");
  for (const auto& [mesh, s] : skinned) {
    Skin& skin = result.meshes[mesh].skin;
    std::vector<double> matrices;
    if (skins[s].contains("inverseBindMatrices"))
      matrices = file.numbers(index(skins[s], "inverseBindMatrices", accessors.size()), 16,
                              Integers::as_flagged);
    for (const Json& joint : list(skins[s], "joints")) {
      const auto found =
          joint.is_number_integer() ? node_index.find(joint.get<int>()) : node_index.end();
      if (found == node_index.end()) refuse("a skin has a bone that does not exist");
      Eigen::Affine3d to_bone = Eigen::Affine3d::Identity();
      const std::size_t at = 16 * skin.bones.size();
      if (at + 16 <= matrices.size())
        to_bone.matrix() = Eigen::Map<const Eigen::Matrix4d>(&matrices[at]);
      to_bone.matrix().row(3) << 0, 0, 0, 1;
      skin.bones.push_back(found->second);
      skin.to_bone.push_back(to_bone);
    }
    if (skin.influences.rows() > 0 &&
        skin.influences.col(1).maxCoeff() >= static_cast<int>(skin.bones.size()))
      refuse("a vertex has a bone that does not exist");
  }
}

std::vector<int> node_list(const Json& object, const char* key, std::size_t nodes) {
  std::vector<int> indices;
  for (const Json& i : list(object, key)) {
    if (!i.is_number_integer() || i < 0 || i >= nodes)
      refuse(fmt::format("\"{}\" names a node that does not exist", key));
    indices.push_back(i.get<int>());
  }
  return indices;
}

/// Adds the nodes in order of the file, parents first.
void GltfConverter::add_nodes(const std::vector<int>& roots) {
  struct Waiting {
    int node, parent;
  };
  std::vector<Waiting> waiting;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) waiting.push_back({*root, -1});
  while (!waiting.empty()) {
    const auto [i, parent] = waiting.back();
    waiting.pop_back();
    if (node_index.count(i))
      refuse(fmt::format("its hierarchy is not a tree: node \"{}\" is in it twice",
                         gltf::name(nodes, i, "nodes")));
    add_node(i, parent);
    const std::vector<int> children = node_list(nodes[i], "children", nodes.size());
    for (auto child = children.rbegin(); child != children.rend(); ++child)
      waiting.push_back({*child, node_index.at(i)});
  }
}

/// Roots of the default scene; in a file without scenes all nodes without a parent.
std::vector<int> roots_of(const Json& json) {
  const Json &nodes = list(json, "nodes"), &scenes = list(json, "scenes");
  if (!scenes.empty())
    return node_list(scenes[std::min(whole(json, "scene", 0), scenes.size() - 1)], "nodes",
                     nodes.size());
  std::set<int> below;
  for (const Json& node : nodes)
    for (const int child : node_list(node, "children", nodes.size())) below.insert(child);
  std::vector<int> roots;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i)
    if (!below.count(i)) roots.push_back(i);
  return roots;
}

/// Warns of extensions that the file requires and that are not supported here.
void warn_of_extensions(const Json& json, ImportedFile& file) {
  const auto known = [](const std::string& name) {
    for (const char* prefix :
         {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_mesh_quantization",
          "KHR_animation_pointer", "KHR_node_", "KHR_xmp"})
      if (name.rfind(prefix, 0) == 0) return true;
    return false;
  };
  for (const Json& name : list(json, "extensionsRequired"))
    if (name.is_string() && !known(name.get<std::string>()))
      file.warnings.push_back(fmt::format(
          "The file needs the glTF extension {}, which is not followed: check sheets and handles.",
          name.get<std::string>()));
}

}  // namespace

ImportedFile import_gltf(const std::filesystem::path& path, Parts parts) try {
  GltfFile file(path, parts);
  GltfConverter converter{file, list(file.json(), "nodes"), {}, {}, {}, {}};
  converter.result.reader = "the file's samplers";
  converter.result.to_z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  converter.result.up_axis = "y up";
  warn_of_extensions(file.json(), converter.result);
  converter.add_nodes(roots_of(file.json()));
  converter.find_bones();
  for (const Take& take : gltf_takes(file)) {
    Take& moved = converter.result.takes.emplace_back();
    moved.name = take.name;
    for (const auto& [index, motion] : take.motions)
      if (const auto node = converter.node_index.find(index); node != converter.node_index.end())
        moved.motions.emplace(node->second, motion);
    for (const auto& [index, tracks] : take.shapes)
      if (const auto node = converter.node_index.find(index); node != converter.node_index.end())
        moved.shapes.emplace(node->second, tracks);
  }
  return std::move(converter.result);
} catch (const Json::exception&) {
  refuse(
      "its JSON is not that of glTF 2: a value has the wrong type (text, number, list or object)");
}

}  // namespace paperbake
