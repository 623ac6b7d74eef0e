#include "formats/scene_import.h"

#include "core/error.h"
#include "formats/apart.h"
#include "formats/scene_message.h"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>

namespace paperbake {
namespace {

const char* const export_again = "Export the file again as FBX, glTF or GLB and check that it opens in the DCC.";
// what an import may take, with much to spare: two million triangles in a GLB of 36 MB take 180 MB and 0.2 s
constexpr std::uint64_t least_memory = std::uint64_t(1) << 30, memory_of_byte = 100;  // [bytes]
constexpr unsigned least_seconds = 5, bytes_a_second = 1 << 20;                        // of CPU time
const std::string pivot_mark = "_$AssimpFbx$_";

[[noreturn]] void reject(const std::filesystem::path& path, const std::string& cause, const std::string& remedy = export_again) {
  throw Error(Fault::scene, path.string(), cause, remedy);
}

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

/// What can be told without the importer, in clearer words than its own.
void check_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) reject(path, "There is no such file.", "Check the path.");
  if (!std::filesystem::is_regular_file(path, error)) reject(path, "This is not a file.", "Name an FBX, glTF or GLB file.");
  const std::string extension = lower_case_extension(path);
  if (extension != ".fbx" && extension != ".gltf" && extension != ".glb")
    reject(path, "This is not an FBX, glTF or GLB file.", "Export the scene from the DCC as .fbx, .gltf or .glb.");
  std::ifstream file(path, std::ios::binary);
  if (!file) reject(path, "The file cannot be opened.", "Check its read permission.");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  unsigned char head[12] = {};
  if (extension != ".glb" || !file.read(reinterpret_cast<char*>(head), sizeof head)) return;
  if (!std::equal(head, head + 4, "glTF")) return;
  const auto number = [&](int at) { return head[at] | head[at + 1] << 8 | head[at + 2] << 16 | std::uintmax_t(head[at + 3]) << 24; };
  const std::uintmax_t version = number(4), promised = number(8);
  if (version != 2) reject(path, fmt::format("This is GLB of version {}; version 2 can be read.", version), "Export the scene as glTF 2.0.");
  if (promised > size)
    reject(path, fmt::format("The file is cut off: it has {} of its {} bytes.", size, promised), "Copy or export it again.");
}

Vector3d vector(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Eigen::Affine3d transform(const aiMatrix4x4& m) {
  Eigen::Affine3d t = Eigen::Affine3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) t(row, column) = m[row][column];
  return t;
}

/// The shortest decimal that the 32-bit number stands for: 0.002 typed by the artist stays 0.002.
double as_typed(float f) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, f).ptr;
  double value = f;
  std::from_chars(text, end, value);
  return value;
}

/// A list of numbers that FBX wrote as text, "[0.3, 0.03]"; else the text itself.
PropertyValue text_or_list(const std::string& text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return text;
  std::vector<double> list;
  for (const char *at = text.data() + 1, *end = text.data() + text.size() - 1; at < end;) {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    double number;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return text;
    list.push_back(number);
    at = next;
  }
  return list;
}

std::optional<PropertyValue> property(const aiMetadataEntry& entry) {
  const auto as = [&](auto* type) { return *static_cast<decltype(type)>(entry.mData); };
  switch (entry.mType) {
    case AI_BOOL: return as(static_cast<bool*>(nullptr)) ? 1.0 : 0.0;
    case AI_INT32: return double(as(static_cast<std::int32_t*>(nullptr)));
    case AI_UINT64: return double(as(static_cast<std::uint64_t*>(nullptr)));
    case AI_FLOAT: return as_typed(as(static_cast<float*>(nullptr)));
    case AI_DOUBLE: return as(static_cast<double*>(nullptr));
    case AI_AISTRING: return text_or_list(static_cast<aiString*>(entry.mData)->C_Str());
    case AI_AIVECTOR3D: {
      const auto* v = static_cast<aiVector3D*>(entry.mData);
      return std::vector<double>{as_typed(v->x), as_typed(v->y), as_typed(v->z)};
    }
    case AI_AIMETADATA: {  // an array of glTF: entries that all carry its key
      const auto* nested = static_cast<aiMetadata*>(entry.mData);
      std::vector<double> list;
      for (unsigned i = 0; i < nested->mNumProperties; ++i) {
        const auto value = property(nested->mValues[i]);
        if (!value || !std::holds_alternative<double>(*value)) return std::nullopt;
        list.push_back(std::get<double>(*value));
      }
      return list;
    }
    default: return std::nullopt;
  }
}

/// Copies the hierarchy, parents before children, in order of the file.
struct Hierarchy {
  ImportedFile& file;
  std::map<std::string, int> first_of_name;  // channels of a take name their node; pivots under their raw name

  void add(const aiNode& node, int parent, bool real) {
    const int index = real ? append(node, parent) : -1;
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(*node.mChildren[i], index, true);
  }

  int append(const aiNode& node, int parent) {
    ImportedNode copy;
    copy.name = node.mName.C_Str();
    copy.parent = parent;
    copy.local = transform(node.mTransformation);
    if (!copy.local.matrix().allFinite())
      throw Error(Fault::scene, fmt::format("node \"{}\"", copy.name), "Its transform contains a value that is not a number.");
    copy.meshes.assign(node.mMeshes, node.mMeshes + node.mNumMeshes);
    for (unsigned i = 0; node.mMetaData && i < node.mMetaData->mNumProperties; ++i)
      if (const auto value = property(node.mMetaData->mValues[i]))
        copy.properties.emplace(node.mMetaData->mKeys[i].C_Str(), *value);
    const int index = static_cast<int>(file.nodes.size());
    first_of_name.emplace(copy.name, index);
    const std::size_t mark = copy.name.find(pivot_mark);
    if (mark != std::string::npos) {
      const std::string part = copy.name.substr(mark + pivot_mark.size());
      copy.pivot = true;
      copy.offsets_mesh_only = part.rfind("Geometric", 0) == 0 && part.find("Inverse") == std::string::npos;
      copy.name.resize(mark);
    }
    file.nodes.push_back(std::move(copy));
    return index;
  }
};

/// assimp puts a root of its own above an FBX file, and above a glTF file that has several roots.
bool is_real_root(const aiScene& scene, bool fbx) {
  const aiNode& root = *scene.mRootNode;
  if (fbx) return false;
  const bool bare = root.mNumMeshes == 0 && !root.mMetaData && root.mTransformation.IsIdentity();
  return root.mName != aiString("ROOT") || !bare || root.mNumChildren == 1;
}

ImportedMesh copy_mesh(const aiMesh& mesh) {
  const auto where = [&] { return fmt::format("mesh \"{}\"", mesh.mName.C_Str()); };
  ImportedMesh copy;
  copy.deformed = mesh.mNumBones > 0 || mesh.mNumAnimMeshes > 0;
  copy.x.resize(mesh.mNumVertices, 3);
  copy.uv.resize(mesh.HasTextureCoords(0) ? mesh.mNumVertices : 0, 2);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    copy.x.row(i) = vector(mesh.mVertices[i]);
    if (copy.uv.rows() > 0) copy.uv.row(i) = vector(mesh.mTextureCoords[0][i]).head<2>();
  }
  if (!copy.x.allFinite() || !copy.uv.allFinite())
    throw Error(Fault::scene, where(), "A vertex contains a value that is not a number.");
  std::vector<int> corners;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices) throw Error(Fault::scene, where(), "A face names a vertex that does not exist.");
      corners.push_back(static_cast<int>(face.mIndices[k]));
    }
  }
  copy.triangles = Eigen::Map<Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return copy;
}

Motion copy_channel(const aiNodeAnim& channel, double ticks_per_second) {
  Motion motion;
  double sum = 0;  // not finite as soon as one value is not
  const auto copy_vectors = [&](const aiVectorKey* keys, unsigned count, std::vector<Key<Vector3d>>& to) {
    for (unsigned i = 0; i < count; ++i) {
      to.push_back({keys[i].mTime / ticks_per_second, vector(keys[i].mValue)});
      sum += to.back().time + to.back().value.sum();
    }
  };
  copy_vectors(channel.mPositionKeys, channel.mNumPositionKeys, motion.translation);
  copy_vectors(channel.mScalingKeys, channel.mNumScalingKeys, motion.scale);
  for (unsigned i = 0; i < channel.mNumRotationKeys; ++i) {
    const aiQuaternion& q = channel.mRotationKeys[i].mValue;
    const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
    motion.rotation.push_back({channel.mRotationKeys[i].mTime / ticks_per_second,
                               rotation.norm() > 0 ? rotation.normalized() : Eigen::Quaterniond::Identity()});
    sum += motion.rotation.back().time + rotation.coeffs().sum();
  }
  if (!std::isfinite(sum))
    throw Error(Fault::scene, fmt::format("node \"{}\"", channel.mNodeName.C_Str()),
                "A key contains a value that is not a number.");
  const auto earlier = [](const auto& a, const auto& b) { return a.time < b.time; };
  std::stable_sort(motion.translation.begin(), motion.translation.end(), earlier);
  std::stable_sort(motion.rotation.begin(), motion.rotation.end(), earlier);
  std::stable_sort(motion.scale.begin(), motion.scale.end(), earlier);
  return motion;
}

Take copy_take(const aiAnimation& animation, const std::map<std::string, int>& nodes) {
  Take take;
  take.name = animation.mName.C_Str();
  const double ticks_per_second = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 1;
  take.seconds = std::isfinite(animation.mDuration) ? animation.mDuration / ticks_per_second : 0;
  for (unsigned i = 0; i < animation.mNumChannels; ++i) {
    const aiNodeAnim& channel = *animation.mChannels[i];
    const auto node = nodes.find(channel.mNodeName.C_Str());
    if (node != nodes.end()) take.motions.emplace(node->second, copy_channel(channel, ticks_per_second));
  }
  return take;
}

/// Rate of an FBX time mode; 0 when the file leaves it open. source: FBX SDK, FbxTime::EMode
double frame_rate(int mode, double custom) {
  switch (mode) {
    case 1: return 120;
    case 2: return 100;
    case 3: return 60;
    case 4: return 50;
    case 5: return 48;
    case 6: case 7: return 30;
    case 8: case 9: return 30000.0 / 1001;
    case 10: return 25;
    case 11: return 24;
    case 12: return 1000;
    case 13: return 24000.0 / 1001;
    case 14: return custom > 0 ? custom : 0;
    default: return 0;
  }
}

/// FBX: unit, frame rate and axes from GlobalSettings, which assimp hands on but does not apply.
void read_global_settings(const aiMetadata& settings, ImportedFile& file) {
  const auto whole = [&](const char* key, int value) {
    std::int32_t found;
    return settings.Get(key, found) ? static_cast<int>(found) : value;
  };
  const auto number = [&](const char* key, double value) {
    float found;
    return settings.Get(key, found) ? as_typed(found) : value;
  };
  file.unit = 0.01 * number("UnitScaleFactor", 1);
  if (!(file.unit > 0) || !std::isfinite(file.unit)) file.unit = 0.01;
  file.fps = frame_rate(whole("FrameRate", 0), number("CustomFrameRate", 0));
  int up = whole("UpAxis", 1), right = whole("CoordAxis", 0);
  if (up < 0 || up > 2 || right < 0 || right > 2 || up == right) up = 1, right = 0;
  const double up_sign = whole("UpAxisSign", 1) < 0 ? -1 : 1;
  // the front axis follows: FBX is right-handed
  const Vector3d z = up_sign * Vector3d::Unit(up), x = (whole("CoordAxisSign", 1) < 0 ? -1 : 1) * Vector3d::Unit(right);
  file.to_z_up.row(0) = x;
  file.to_z_up.row(1) = z.cross(x);
  file.to_z_up.row(2) = z;
  file.up_axis = fmt::format("{}{} up", up_sign < 0 ? "-" : "", "xyz"[up]);
}

ImportedFile copy_scene(const aiScene& scene, bool fbx) {
  ImportedFile file;
  file.fbx = fbx;
  file.to_z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  file.up_axis = "y up";
  if (fbx && scene.mMetaData) read_global_settings(*scene.mMetaData, file);
  Hierarchy hierarchy{file, {}};
  hierarchy.add(*scene.mRootNode, -1, is_real_root(scene, fbx));
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) file.meshes.push_back(copy_mesh(*scene.mMeshes[i]));
  for (unsigned i = 0; i < scene.mNumAnimations; ++i)
    file.takes.push_back(copy_take(*scene.mAnimations[i], hierarchy.first_of_name));
  return file;
}

}  // namespace

ImportedFile import_here(const std::filesystem::path& path) try {
  Assimp::Importer importer;
  // without them the rotations about Maya's pivots would be lost: measured on maya_anim_pivot_rotate
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) reject(path, fmt::format("The file cannot be read: {}", importer.GetErrorString()));
  aiString format;
  if (scene->mMetaData) scene->mMetaData->Get("SourceAsset_Format", format);
  const std::string name = format.C_Str();
  const bool fbx = name.find("FBX") != std::string::npos;
  if (!fbx && name.find("glTF2") == std::string::npos)
    reject(path, "This is not an FBX, glTF 2 or GLB file, whatever its name says.",
           "Export the scene from the DCC as .fbx, .gltf or .glb.");
  return copy_scene(*scene, fbx);
} catch (const Error& error) {
  if (error.place == path.string()) throw;
  throw Error(error.fault, path.filename().string() + ", " + error.place, error.cause, export_again);
} catch (const std::bad_alloc&) {
  reject(path, "The file asks for more memory than a scene of its size needs.");
} catch (const std::exception& error) {
  reject(path, fmt::format("The file cannot be read: {}.", error.what()));
}

ImportedFile import_file(const std::filesystem::path& path) {
  check_file(path);
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  const auto import = [&path] {
    try {
      return bytes_of({import_here(path), "", "", ""});
    } catch (const Error& error) {
      return bytes_of({{}, error.place, error.cause, error.remedy});
    }
  };
  const Apart apart = run_apart(import, {least_memory + memory_of_byte * size, least_seconds + static_cast<unsigned>(size / bytes_a_second)});
  if (!apart.bytes) reject(path, fmt::format("The file cannot be read: its import {}.", apart.ended));
  try {
    SceneMessage message = message_of(*apart.bytes);
    if (!message.cause.empty()) throw Error(Fault::scene, message.place, message.cause, message.remedy);
    return std::move(message.file);
  } catch (const std::runtime_error& error) {
    if (dynamic_cast<const Error*>(&error)) throw;
    reject(path, fmt::format("The file cannot be read: {}.", error.what()));
  }
}

}  // namespace paperbake
