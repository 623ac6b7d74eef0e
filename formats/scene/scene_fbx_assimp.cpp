// FBX import with assimp, for builds without ufbx (cmake/ufbx.cmake).

#include "formats/scene/scene_fbx.h"

#include "core/model/error.h"
#include "formats/scene/assimp_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

namespace paperbake {
namespace {

const std::string pivot_mark = "_$AssimpFbx$_";

Motion copy_channel(const aiNodeAnim& channel, double ticks_per_second) {
  Motion motion;
  double sum = 0;  // not finite if any value is not
  const auto at = [&](double ticks) {
    sum += ticks / ticks_per_second;
    return motion.key_times.emplace_back(ticks / ticks_per_second);
  };
  const auto copy_vectors = [&](const aiVectorKey* keys, unsigned count,
                                std::vector<Key<Vector3d>>& to) {
    for (unsigned i = 0; i < count; ++i) {
      to.push_back({at(keys[i].mTime), vector(keys[i].mValue)});
      sum += to.back().value.sum();
    }
  };
  copy_vectors(channel.mPositionKeys, channel.mNumPositionKeys, motion.translation.keys);
  copy_vectors(channel.mScalingKeys, channel.mNumScalingKeys, motion.scale.keys);
  for (unsigned i = 0; i < channel.mNumRotationKeys; ++i) {
    const aiQuaternion& q = channel.mRotationKeys[i].mValue;
    const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
    motion.rotation.keys.push_back(
        {at(channel.mRotationKeys[i].mTime),
         rotation.norm() > 0 ? rotation.normalized() : Eigen::Quaterniond::Identity()});
    sum += rotation.coeffs().sum();
  }
  if (!std::isfinite(sum))
    throw Error(ErrorCode::scene, fmt::format("node \"{}\"", channel.mNodeName.C_Str()),
                "A key contains a value that is not a number.");
  const auto sort = [](auto& keys) {
    std::stable_sort(keys.begin(), keys.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
  };
  sort(motion.translation.keys);
  sort(motion.rotation.keys);
  sort(motion.scale.keys);
  std::sort(motion.key_times.begin(), motion.key_times.end());
  motion.key_times.erase(std::unique(motion.key_times.begin(), motion.key_times.end()),
                         motion.key_times.end());
  return motion;
}

Take copy_take(const aiAnimation& animation, const std::map<std::string, int>& nodes) {
  Take take;
  take.name = animation.mName.C_Str();
  const double ticks_per_second = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 1;
  take.end = std::isfinite(animation.mDuration) ? animation.mDuration / ticks_per_second : 0;
  for (unsigned i = 0; i < animation.mNumChannels; ++i) {
    const aiNodeAnim& channel = *animation.mChannels[i];
    const auto node = nodes.find(channel.mNodeName.C_Str());
    if (node != nodes.end())
      take.motions.emplace(node->second, copy_channel(channel, ticks_per_second));
  }
  return take;
}

/// Frame rate of an FBX time mode [1/s]; 0 when the file does not state it.
/// source  FBX SDK, FbxTime::EMode
double frame_rate(int mode, double custom) {
  switch (mode) {
    case 1:
      return 120;
    case 2:
      return 100;
    case 3:
      return 60;
    case 4:
      return 50;
    case 5:
      return 48;
    case 6:
    case 7:
      return 30;
    case 8:
    case 9:
      return 30000.0 / 1001;
    case 10:
      return 25;
    case 11:
      return 24;
    case 12:
      return 1000;
    case 13:
      return 24000.0 / 1001;
    case 14:
      return custom > 0 ? custom : 0;
    default:
      return 0;
  }
}

/// Sets unit, frame rate and axes from GlobalSettings, which assimp passes on but does not apply.
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
  if (up < 0 || up > 2 || right < 0 || right > 2 || up == right) {
    up = 1;
    right = 0;
  }
  const double up_sign = whole("UpAxisSign", 1) < 0 ? -1 : 1;
  // the front axis follows from these, since FBX is right-handed
  const Vector3d z = up_sign * Vector3d::Unit(up),
                 x = (whole("CoordAxisSign", 1) < 0 ? -1 : 1) * Vector3d::Unit(right);
  file.to_z_up.row(0) = x;
  file.to_z_up.row(1) = z.cross(x);
  file.to_z_up.row(2) = z;
  file.up_axis = fmt::format("{}{} up", up_sign < 0 ? "-" : "", "xyz"[up]);
}

void mark_pivot(ImportedNode& node) {
  const std::size_t mark = node.name.find(pivot_mark);
  if (mark == std::string::npos) return;
  const std::string part = node.name.substr(mark + pivot_mark.size());
  node.pivot = true;
  node.offsets_mesh_only =
      part.rfind("Geometric", 0) == 0 && part.find("Inverse") == std::string::npos;
  node.name.resize(mark);
}

/// Warns of moving nodes that share a name: assimp's takes refer to nodes by name.
void warn_of_doubled_names(ImportedFile& file) {
  std::map<std::string, int> count;
  std::set<int> moved;
  for (const ImportedNode& node : file.nodes) count[node.name] += !node.pivot;
  for (const Take& take : file.takes)
    for (const auto& [node, motion] : take.motions) moved.insert(node);
  for (const int node : moved)
    if (const std::string& name = file.nodes[node].name; count[name] > 1)
      file.warnings.push_back(fmt::format(
          "{} nodes have the name \"{}\": only the first of them is moved.", count[name], name));
}

}  // namespace

ImportedFile import_fbx(const std::filesystem::path& path, std::optional<double>) {
  Assimp::Importer importer;
  const aiScene& scene = assimp_scene(importer, path, "FBX");
  ImportedFile file;
  file.fbx = file.start_lost = true;
  file.reader = "assimp: keys joined by straight lines";
  file.warnings.push_back(
      "This program was built without ufbx (its build had no cargo, or no network): of an FBX file "
      "only curves with a key on every frame are read "
      "exactly. Steps, tangents, layers and scale inheritance are lost, which can be all of the "
      "motion of Maya's unbaked curves.");
  file.to_z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  file.up_axis = "y up";
  if (scene.mMetaData) read_global_settings(*scene.mMetaData, file);
  // the channels of a take name their node; a pivot keeps its raw name there
  std::map<std::string, int> first_of_name;
  copy_nodes(*scene.mRootNode, file, [&](const aiNode& node, int index) {
    first_of_name.emplace(node.mName.C_Str(), index);
    mark_pivot(file.nodes[index]);
  });
  copy_meshes(scene, file);
  for (unsigned i = 0; i < scene.mNumAnimations; ++i)
    file.takes.push_back(copy_take(*scene.mAnimations[i], first_of_name));
  warn_of_doubled_names(file);
  return file;
}

}  // namespace paperbake
