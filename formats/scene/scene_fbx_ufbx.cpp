// FBX import with ufbx, which cmake/ufbx.cmake downloads.

#include "formats/scene/scene_fbx.h"

#include "core/model/error.h"
#include "formats/scene/scene_properties.h"

#include <ufbx.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string_view>
#include <unordered_map>

namespace paperbake {
namespace {

// [frames] a key this near to a frame is meant to be on it
constexpr double on_key = 0.01;
constexpr double max_sampled_frames = 100001;  // [frames] one more than scene_nodes.cpp permits
constexpr double max_samples = 2e7;  // nodes x frames of all takes, which would take gigabytes
constexpr std::uint32_t max_node_depth = 10000;
// [bytes] memory limit for parsing, and again for its result
constexpr std::size_t parser_min_memory = std::size_t(1) << 29, parser_memory_per_byte = 50;

std::string text_of(const ufbx_string& s) { return {s.data, s.length}; }
Vector3d vector(const ufbx_vec3& v) { return {v.x, v.y, v.z}; }
Eigen::Quaterniond rotation(const ufbx_quat& q) { return {q.w, q.x, q.y, q.z}; }

Eigen::Affine3d affine(const ufbx_matrix& m) {
  Eigen::Affine3d t = Eigen::Affine3d::Identity();
  for (int column = 0; column < 4; ++column)
    t.matrix().col(column).head<3>() = vector(m.cols[column]);
  return t;
}

[[noreturn]] void reject_number(const ufbx_string& node, const char* what) {
  throw Error(ErrorCode::scene, fmt::format("node \"{}\"", text_of(node)),
              fmt::format("{} contains a value that is not a number.", what), export_again);
}

std::optional<PropertyValue> value_of(const ufbx_prop& p) {
  switch (p.type) {
    case UFBX_PROP_BOOLEAN:
    case UFBX_PROP_INTEGER:
      return double(p.value_int);
    case UFBX_PROP_NUMBER:
    case UFBX_PROP_DISTANCE:
      return double(p.value_real);
    case UFBX_PROP_STRING:
      return text_or_list(text_of(p.value_str));
    case UFBX_PROP_VECTOR:
    case UFBX_PROP_COLOR:
    case UFBX_PROP_TRANSLATION:
    case UFBX_PROP_ROTATION:
    case UFBX_PROP_SCALING:
      return std::vector<double>{p.value_vec3.x, p.value_vec3.y, p.value_vec3.z};
    default:
      return std::nullopt;
  }
}

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && std::isspace(static_cast<unsigned char>(s.front()))) s.remove_prefix(1);
  while (!s.empty() && std::isspace(static_cast<unsigned char>(s.back()))) s.remove_suffix(1);
  return s;
}

/// Adds the user-defined properties of 3ds Max, which are lines "key = value".
void add_max_properties(std::string_view lines, ImportedNode& node) {
  while (!lines.empty()) {
    const std::string_view line = lines.substr(0, lines.find('\n'));
    lines.remove_prefix(std::min(lines.size(), line.size() + 1));
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos)
      node.properties.emplace(trimmed(line.substr(0, equals)),
                              text_or_list(std::string(trimmed(line.substr(equals + 1)))));
  }
}

/// Adds custom properties. To be called for the node first, then for its attributes (bone, mesh):
/// those added first win.
void add_properties(const ufbx_props& props, ImportedNode& node) {
  for (const ufbx_prop& p : props.props) {
    const std::string name = text_of(p.name);
    if (name == "UDP3DSMAX")
      add_max_properties(text_of(p.value_str), node);
    else if (!(p.flags & UFBX_PROP_FLAG_USER_DEFINED) && name.rfind("paper_", 0) != 0)
      continue;
    else if (const auto value = value_of(p))
      node.properties.emplace(name, *value);
  }
}

/// Edges with a crease weight, as for subdivision, and faces with two corners, which are loose
/// edges.
Edges creases_of(const ufbx_mesh& mesh) {
  std::vector<int> ends;
  for (std::size_t i = 0; i < std::min(mesh.edge_crease.count, mesh.edges.count); ++i)
    if (mesh.edge_crease[i] > 0) {
      ends.push_back(static_cast<int>(mesh.edges[i].a));
      ends.push_back(static_cast<int>(mesh.edges[i].b));
    }
  for (const ufbx_face& face : mesh.faces)
    if (face.num_indices == 2) {
      ends.push_back(static_cast<int>(face.index_begin));
      ends.push_back(static_cast<int>(face.index_begin) + 1);
    }
  return Eigen::Map<Edges>(ends.data(), static_cast<Eigen::Index>(ends.size() / 2), 2);
}

/// The uv sets and colours, each with one value for each corner of the mesh.
std::vector<AuthoredAttribute> attributes_of(const ufbx_mesh& mesh) {
  const auto corners = static_cast<Eigen::Index>(mesh.num_indices);
  std::vector<AuthoredAttribute> found;
  for (const ufbx_uv_set& set : mesh.uv_sets) {
    if (!set.vertex_uv.exists) continue;
    found.push_back({text_of(set.name), AttributeKind::uv, AttributeValues(corners, 2)});
    for (Eigen::Index i = 0; i < corners; ++i) {
      const ufbx_vec2 at = ufbx_get_vertex_vec2(&set.vertex_uv, i);
      found.back().values.row(i) << at.x, at.y;
    }
  }
  for (const ufbx_color_set& set : mesh.color_sets) {
    if (!set.vertex_color.exists) continue;
    found.push_back({text_of(set.name), AttributeKind::colour, AttributeValues(corners, 4)});
    for (Eigen::Index i = 0; i < corners; ++i) {
      const ufbx_vec4 at = ufbx_get_vertex_vec4(&set.vertex_color, i);
      found.back().values.row(i) << at.x, at.y, at.z, at.w;
    }
  }
  return found;
}

/// What of the deformation of a mesh is not followed; empty: all is.
std::string not_followed(const ufbx_mesh& mesh) {
  if (mesh.cache_deformers.count > 0) return "The cache";
  if (mesh.skin_deformers.count > 1) return "The second skin";
  if (mesh.skin_deformers.count == 1 &&
      mesh.skin_deformers[0]->skinning_method == UFBX_SKINNING_METHOD_DUAL_QUATERNION)
    return "Skinning by dual quaternions (preserve volume)";
  return "";
}

/// The corners of a mesh that bones move. Its bones are found when all nodes are known.
void copy_influences(const ufbx_mesh& mesh, ImportedMesh& copy) {
  if (mesh.skin_deformers.count == 0) return;
  const ufbx_skin_deformer& skin = *mesh.skin_deformers[0];
  std::vector<int> pairs;
  std::vector<double> weights;
  for (std::size_t corner = 0; corner < mesh.num_indices; ++corner) {
    const std::uint32_t vertex = mesh.vertex_indices[corner];
    if (vertex >= skin.vertices.count) continue;
    const ufbx_skin_vertex& of = skin.vertices[vertex];
    for (std::uint32_t k = 0; k < of.num_weights; ++k) {
      const ufbx_skin_weight& by = skin.weights[of.weight_begin + k];
      if (!(by.weight > 0) || !skin.clusters[by.cluster_index]->bone_node) continue;
      pairs.push_back(static_cast<int>(corner));
      pairs.push_back(static_cast<int>(by.cluster_index));
      weights.push_back(by.weight);
    }
  }
  const auto count = static_cast<Eigen::Index>(weights.size());
  copy.skin.influences =
      Eigen::Map<Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor>>(pairs.data(), count, 2);
  copy.skin.weights = Eigen::Map<Eigen::VectorXd>(weights.data(), count);
}

/// Calls the visitor with every shape of the blend channels of a mesh, in-between shapes included:
/// the channel, and the number of its keyframe.
template <class Visit>
void for_each_shape(const ufbx_mesh& mesh, Visit visit) {
  for (const ufbx_blend_deformer* deformer : mesh.blend_deformers)
    for (const ufbx_blend_channel* channel : deformer->channels)
      for (std::size_t k = 0; k < channel->keyframes.count; ++k) visit(*channel, k);
}

/// How much of the k-th keyframe of a channel is in the mesh at a weight of the channel: linear
/// from one keyframe to the next.
double share_of_shape(const ufbx_blend_channel& channel, std::size_t k, double weight) {
  const auto at = [&](std::size_t i) { return channel.keyframes[i].target_weight; };
  const double before = k > 0 ? at(k - 1) : 0;
  const bool last = k + 1 == channel.keyframes.count;
  if (at(k) == before) return 0;
  if (weight <= at(k) || last) {
    if (k > 0 && weight <= before) return 0;
    return (weight - before) / (at(k) - before);
  }
  return weight >= at(k + 1) ? 0 : (at(k + 1) - weight) / (at(k + 1) - at(k));
}

void copy_shapes(const ufbx_mesh& mesh, const Eigen::Affine3d& to_node, ImportedMesh& copy) {
  for_each_shape(mesh, [&](const ufbx_blend_channel& channel, std::size_t k) {
    const ufbx_blend_shape& shape = *channel.keyframes[k].shape;
    Points3 of_vertices = Points3::Zero(static_cast<Eigen::Index>(mesh.num_vertices), 3);
    for (std::size_t i = 0; i < shape.num_offsets; ++i)
      if (shape.offset_vertices[i] < mesh.num_vertices)
        of_vertices.row(shape.offset_vertices[i]) +=
            (to_node.linear() * vector(shape.position_offsets[i])).transpose();
    Points3& target = copy.targets.emplace_back(copy.x.rows(), 3);
    for (Eigen::Index corner = 0; corner < copy.x.rows(); ++corner)
      target.row(corner) = of_vertices.row(mesh.vertex_indices[corner]);
    copy.target_weights.push_back(share_of_shape(channel, k, channel.weight));
  });
}

ImportedMesh copy_mesh(const ufbx_mesh& mesh, const ufbx_node& node) {
  ImportedMesh copy;
  const Eigen::Affine3d to_node = affine(node.geometry_to_node);
  const auto corners = static_cast<Eigen::Index>(mesh.num_indices);
  copy.deformed =
      mesh.skin_deformers.count + mesh.blend_deformers.count + mesh.cache_deformers.count > 0;
  copy.x.resize(corners, 3);
  for (Eigen::Index i = 0; i < corners; ++i)
    copy.x.row(i) = to_node * vector(ufbx_get_vertex_vec3(&mesh.vertex_position, i));
  copy.attributes = attributes_of(mesh);
  const bool finite = std::all_of(copy.attributes.begin(), copy.attributes.end(),
                                  [](const AuthoredAttribute& a) { return a.values.allFinite(); });
  if (!copy.x.allFinite() || !finite) reject_number(node.name, "A vertex");
  for (const ufbx_material* material : node.materials)
    copy.materials.push_back(material ? text_of(material->name) : std::string());
  std::vector<std::uint32_t> triangles(3 * mesh.max_face_triangles);
  std::vector<int> all;
  for (std::size_t f = 0; f < mesh.faces.count; ++f) {
    const ufbx_face& face = mesh.faces[f];
    if (face.num_indices < 3) continue;  // points and lines
    const std::size_t count =
        ufbx_triangulate_face(triangles.data(), triangles.size(), &mesh, face);
    all.insert(all.end(), triangles.begin(), triangles.begin() + 3 * count);
    if (copy.materials.empty()) continue;
    const std::size_t material = f < mesh.face_material.count ? mesh.face_material[f] : 0;
    copy.material_of.insert(copy.material_of.end(), count,
                            material < copy.materials.size() ? static_cast<int>(material) : -1);
  }
  copy.triangles = Eigen::Map<Triangles>(all.data(), static_cast<Eigen::Index>(all.size() / 3), 3);
  copy.creases = creases_of(mesh);
  copy.not_followed = not_followed(mesh);
  copy_influences(mesh, copy);
  copy_shapes(mesh, to_node, copy);
  return copy;
}

/// Converts a ufbx scene to an ImportedFile.
struct FbxConverter {
  const ufbx_scene& scene;
  double fps;
  ImportedFile file;
  std::unordered_map<const ufbx_element*, int> node_index;
  double samples = 0;
  std::set<std::string> thinned;
  struct MeshOfNode {
    const ufbx_mesh* mesh;
    const ufbx_node* node;
    int copy;  // index of the mesh
  };
  std::vector<MeshOfNode> deformed = {};  // meshes with bones or blend shapes

  void copy_nodes();
  void copy_node(const ufbx_node& node);
  void find_bones();
  void copy_weights(const ufbx_anim_stack& stack, Take& take);
  void copy_take(const ufbx_anim_stack& stack);
  Motion sample(const ufbx_node& node, const ufbx_anim_stack& stack, std::vector<double> key_times);
};

/// In order of the file, parents first.
void FbxConverter::copy_nodes() {
  std::vector<const ufbx_node*> waiting{scene.root_node};
  while (!waiting.empty()) {
    const ufbx_node& node = *waiting.back();
    waiting.pop_back();
    if (!node.is_root) copy_node(node);
    for (std::size_t i = node.children.count; i-- > 0;) waiting.push_back(node.children[i]);
  }
}

void FbxConverter::copy_node(const ufbx_node& node) {
  const auto index_of = [&](const ufbx_node* other) {
    const auto found = other ? node_index.find(&other->element) : node_index.end();
    return found == node_index.end() ? -1 : found->second;
  };
  ImportedNode copy;
  copy.name = text_of(node.name);
  copy.parent = index_of(node.parent);
  copy.local.translate(vector(node.local_transform.translation))
      .rotate(rotation(node.local_transform.rotation));
  copy.scale = vector(node.local_transform.scale);
  copy.own_scale = node.inherit_mode != UFBX_INHERIT_MODE_NORMAL;
  copy.scale_from = index_of(node.inherit_scale_node);
  if (!copy.local.matrix().allFinite() || !copy.scale.allFinite())
    reject_number(node.name, "Its transform");
  add_properties(node.props, copy);
  for (const ufbx_element* attribute : node.all_attribs) {
    add_properties(attribute->props, copy);
    const ufbx_mesh* mesh = ufbx_as_mesh(attribute);
    if (!mesh || !mesh->vertex_position.exists) continue;
    copy.meshes.push_back(static_cast<int>(file.meshes.size()));
    file.meshes.push_back(copy_mesh(*mesh, node));
    if (file.meshes.back().deformed) deformed.push_back({mesh, &node, copy.meshes.back()});
  }
  node_index.emplace(&node.element, static_cast<int>(file.nodes.size()));
  file.nodes.push_back(std::move(copy));
}

/// Sets the bones of the meshes that have some. To be called when all nodes have been copied.
void FbxConverter::find_bones() {
  for (const MeshOfNode& at : deformed) {
    if (at.mesh->skin_deformers.count == 0) continue;
    Skin& skin = file.meshes[at.copy].skin;
    const Eigen::Affine3d to_node = affine(at.node->geometry_to_node);
    for (const ufbx_skin_cluster* cluster : at.mesh->skin_deformers[0]->clusters) {
      const auto bone =
          cluster->bone_node ? node_index.find(&cluster->bone_node->element) : node_index.end();
      skin.bones.push_back(bone == node_index.end() ? node_index.at(&at.node->element)
                                                    : bone->second);
      skin.to_bone.push_back(affine(cluster->geometry_to_bone) * to_node.inverse());
    }
  }
}

/// Whether a curve looks as if it had a key on every frame once and lost those on straight parts,
/// as by Simplify of Blender's exporter.
bool is_thinned(const ufbx_anim_curve& curve, double fps) {
  bool next_frame = false, gap = false;
  for (std::size_t k = 1; k < curve.keyframes.count; ++k) {
    const double frames = (curve.keyframes[k].time - curve.keyframes[k - 1].time) * fps;
    if (curve.keyframes[k - 1].interpolation != UFBX_INTERPOLATION_LINEAR) return false;
    next_frame |= std::abs(frames - 1) < on_key;
    gap |= frames > 1 + on_key;
  }
  return next_frame && gap;
}

/// Whether a property has an influence on the transform of a node.
bool moves_node(std::string_view property) {
  constexpr std::array names{UFBX_Lcl_Translation, UFBX_Lcl_Rotation,  UFBX_Lcl_Scaling,
                             UFBX_PreRotation,     UFBX_PostRotation,  UFBX_RotationOffset,
                             UFBX_ScalingOffset,   UFBX_RotationPivot, UFBX_ScalingPivot,
                             UFBX_RotationOrder};
  return std::find(names.begin(), names.end(), property) != names.end();
}

void add_key_times(const ufbx_anim_value& value, std::vector<double>& times) {
  for (const ufbx_anim_curve* curve : value.curves)
    for (std::size_t k = 0; curve && k < curve->keyframes.count; ++k)
      times.push_back(curve->keyframes[k].time);
}

void sort_and_merge(std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
}

/// Adds a sample to a track. While all samples are equal, only the last is kept. `same` counts the
/// samples at the end that repeat the one before them, so that the caller can remove them.
template <class Value>
void add_sample(Track<Value>& track, double time, const Value& value, std::size_t& same) {
  const auto equal = [&](const Key<Value>& key) {
    if constexpr (std::is_same_v<Value, Vector3d>)
      return key.value == value;
    else
      return key.value.coeffs() == value.coeffs();
  };
  same = !track.keys.empty() && equal(track.keys.back()) ? same + 1 : 0;
  if (same > 0 && same == track.keys.size()) {
    track.keys.front().time = time;
    same = 0;
  } else
    track.keys.push_back({time, value});
}

Motion FbxConverter::sample(const ufbx_node& node, const ufbx_anim_stack& stack,
                            std::vector<double> key_times) {
  Motion motion;
  sort_and_merge(key_times);
  const double first = std::floor(std::min(stack.time_begin, key_times.front()) * fps + on_key);
  const double last = std::min(std::ceil(std::max(stack.time_end, key_times.back()) * fps - on_key),
                               first + max_sampled_frames);
  if (!std::isfinite(first) || !std::isfinite(last)) reject_number(node.name, "A key");
  samples += last - first + 1;
  if (samples > max_samples)
    throw Error(ErrorCode::scene, fmt::format("take \"{}\"", text_of(stack.name)),
                "It has too many frames and nodes.",
                "Export only the sheets and handles, or a shorter range.");
  std::size_t same_t = 0, same_r = 0, same_s = 0;
  for (double frame = first; frame <= last; ++frame) {
    double time = frame / fps;
    const auto key = std::lower_bound(key_times.begin(), key_times.end(), time - on_key / fps);
    // exactly at the key, so that a step on this frame has been made
    if (key != key_times.end() && *key <= time + on_key / fps) time = *key;
    const ufbx_transform t = ufbx_evaluate_transform(stack.anim, &node, time);
    const Eigen::Quaterniond turn = rotation(t.rotation).normalized();
    if (!vector(t.translation).allFinite() || !turn.coeffs().allFinite() ||
        !vector(t.scale).allFinite())
      reject_number(node.name, "A key");
    add_sample(motion.translation, frame / fps, vector(t.translation), same_t);
    add_sample(motion.rotation, frame / fps, turn, same_r);
    add_sample(motion.scale, frame / fps, vector(t.scale), same_s);
  }
  motion.translation.keys.resize(motion.translation.keys.size() - same_t);
  motion.rotation.keys.resize(motion.rotation.keys.size() - same_r);
  motion.scale.keys.resize(motion.scale.keys.size() - same_s);
  motion.key_times = std::move(key_times);
  return motion;
}

/// Samples the weights of blend shapes at every frame of a take.
void FbxConverter::copy_weights(const ufbx_anim_stack& stack, Take& take) {
  for (const MeshOfNode& at : deformed) {
    std::vector<double> key_times;
    for (const ufbx_anim_layer* layer : stack.layers)
      for (const ufbx_anim_prop& p : layer->anim_props)
        if (const ufbx_blend_channel* channel = ufbx_as_blend_channel(p.element))
          for (const ufbx_blend_deformer* deformer : at.mesh->blend_deformers)
            for (const ufbx_blend_channel* own : deformer->channels)
              if (own == channel) add_key_times(*p.anim_value, key_times);
    if (key_times.size() < 2) continue;
    sort_and_merge(key_times);
    const double first = std::floor(key_times.front() * fps + on_key),
                 last = std::min(std::ceil(key_times.back() * fps - on_key),
                                 first + max_sampled_frames);
    if (!std::isfinite(first) || !std::isfinite(last)) reject_number(at.node->name, "A key");
    std::vector<Track<Vector3d>>& tracks = take.shapes[node_index.at(&at.node->element)];
    tracks.clear();
    for_each_shape(*at.mesh, [&](const ufbx_blend_channel& channel, std::size_t k) {
      Track<Vector3d>& track = tracks.emplace_back();
      for (double frame = first; frame <= last; ++frame)
        track.keys.push_back(
            {frame / fps,
             {share_of_shape(channel, k,
                             ufbx_evaluate_blend_weight(stack.anim, &channel, frame / fps)),
              0, 0}});
    });
  }
}

void FbxConverter::copy_take(const ufbx_anim_stack& stack) {
  Take take;
  take.name = text_of(stack.name);
  take.begin = std::isfinite(stack.time_begin) ? stack.time_begin : 0;
  take.end = std::isfinite(stack.time_end) ? stack.time_end : take.begin;
  std::map<const ufbx_node*, std::vector<double>> keys;
  std::vector<const ufbx_node*> order;
  for (const ufbx_anim_layer* layer : stack.layers) {
    std::vector<double> of_weight;
    for (const ufbx_anim_prop& p : layer->anim_props)
      if (p.element == &layer->element) add_key_times(*p.anim_value, of_weight);
    for (const ufbx_anim_prop& p : layer->anim_props) {
      const ufbx_node* node = ufbx_as_node(p.element);
      if (!node || node->is_root || !moves_node({p.prop_name.data, p.prop_name.length})) continue;
      std::vector<double> times;
      add_key_times(*p.anim_value, times);
      if (times.empty()) continue;
      if (!keys.count(node)) order.push_back(node);
      std::vector<double>& all = keys[node];
      all.insert(all.end(), times.begin(), times.end());
      all.insert(all.end(), of_weight.begin(), of_weight.end());
      for (const ufbx_anim_curve* curve : p.anim_value->curves)
        if (curve && is_thinned(*curve, fps)) thinned.insert(text_of(node->name));
    }
  }
  for (const ufbx_node* node : order)
    if (const auto copy = node_index.find(&node->element); copy != node_index.end())
      take.motions.emplace(copy->second, sample(*node, stack, std::move(keys[node])));
  copy_weights(stack, take);
  file.takes.push_back(std::move(take));
}

Vector3d direction(ufbx_coordinate_axis axis) {
  return (axis % 2 ? -1 : 1) * Vector3d::Unit(axis / 2);
}

/// ufbx stores rates such as 30000/1001 as 32-bit floats; this gives the exact value.
double rate_of_video(double fps) {
  const double exact = std::round(fps * 1.001) / 1.001;
  return std::abs(fps / exact - 1) < 1e-5 && std::round(fps) != fps ? exact : fps;
}

/// Sets unit, frame rate and axes of the file.
void copy_settings(const ufbx_scene_settings& settings, ImportedFile& file) {
  file.unit =
      settings.unit_meters > 0 && std::isfinite(settings.unit_meters) ? settings.unit_meters : 0.01;
  file.fps = settings.time_mode != UFBX_TIME_MODE_DEFAULT && settings.frames_per_second > 0 &&
                     std::isfinite(settings.frames_per_second)
                 ? rate_of_video(settings.frames_per_second)
                 : 0;
  ufbx_coordinate_axes axes = settings.axes;
  if (!ufbx_coordinate_axes_valid(axes)) axes = ufbx_axes_right_handed_y_up;
  file.to_z_up.row(0) = direction(axes.right);
  file.to_z_up.row(1) = -direction(axes.front);
  file.to_z_up.row(2) = direction(axes.up);
  file.up_axis = fmt::format("{}{} up", axes.up % 2 ? "-" : "", "xyz"[axes.up / 2]);
}

/// Whether the file does not say which frame its clip starts at: Blender's "All Actions" writes a
/// stack "object|action" for every action and object, each from time 0.
bool has_lost_start(const ufbx_scene& scene) {
  const bool blender = scene.metadata.exporter == UFBX_EXPORTER_BLENDER_BINARY ||
                       scene.metadata.exporter == UFBX_EXPORTER_BLENDER_ASCII;
  const std::size_t stacks = scene.anim_stacks.count;
  return blender &&
         (stacks > 1 ||
          (stacks == 1 && text_of(scene.anim_stacks[0]->name).find('|') != std::string::npos)) &&
         std::all_of(scene.anim_stacks.begin(), scene.anim_stacks.end(),
                     [](const ufbx_anim_stack* stack) { return stack->time_begin == 0; });
}

/// Rate of the frames to sample [1/s]: the one that scene_nodes will determine.
double sampling_rate(const ImportedFile& file, std::optional<double> asked) {
  if (asked && *asked > 0 && std::isfinite(*asked)) return *asked;
  if (file.fps > 0) return file.fps;
  for (const ImportedNode& node : file.nodes)
    if (const auto found = node.properties.find("paper_fps"); found != node.properties.end())
      if (const double* fps = std::get_if<double>(&found->second);
          fps && *fps > 0 && std::isfinite(*fps))
        return *fps;
  return 24;
}

void add_warnings(const FbxConverter& converter, ImportedFile& file) {
  if (!converter.thinned.empty())
    file.warnings.push_back(
        fmt::format("Keys of {} node(s), first \"{}\", look thinned out (Simplify of Blender's "
                    "exporter, 1.0 unless set): they may be off by about 1 % of their motion; "
                    "export with Simplify 0.",
                    converter.thinned.size(), *converter.thinned.begin()));
  if (converter.scene.constraints.count > 0)
    file.warnings.push_back(fmt::format(
        "{} constraint(s), first \"{}\", are not followed: bake what they move into "
        "keys before the export.",
        converter.scene.constraints.count, text_of(converter.scene.constraints[0]->name)));
}

}  // namespace

ImportedFile import_fbx(const std::filesystem::path& path, std::optional<double> fps) {
  ufbx_load_opts options{};
  options.file_format = UFBX_FILE_FORMAT_FBX;
  options.ignore_embedded = true;
  options.node_depth_limit = max_node_depth;
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  options.temp_allocator.memory_limit = options.result_allocator.memory_limit =
      parser_min_memory + (unknown ? 0 : parser_memory_per_byte * size);
  ufbx_error error{};
  const std::unique_ptr<ufbx_scene, void (*)(ufbx_scene*)> scene(
      ufbx_load_file(path.c_str(), &options, &error), ufbx_free_scene);
  if (!scene) {
    if (error.type == UFBX_ERROR_UNRECOGNIZED_FILE_FORMAT) throw foreign_file(path);
    throw Error(ErrorCode::scene, path.string(),
                fmt::format("The file cannot be read: {}.", text_of(error.description)),
                export_again);
  }
  FbxConverter converter{*scene, 24, {}, {}, 0, {}, {}};
  converter.file.fbx = true;
  converter.file.reader = fmt::format(
      "ufbx {}.{}.{}, which evaluates the file's own curves", ufbx_source_version / 1000000,
      ufbx_source_version / 1000 % 1000, ufbx_source_version % 1000);
  copy_settings(scene->settings, converter.file);
  converter.copy_nodes();
  converter.find_bones();
  converter.fps = sampling_rate(converter.file, fps);
  for (const ufbx_anim_stack* stack : scene->anim_stacks) converter.copy_take(*stack);
  converter.file.start_lost = has_lost_start(*scene);
  add_warnings(converter, converter.file);
  return std::move(converter.file);
}

}  // namespace paperbake
