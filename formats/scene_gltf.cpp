#include "formats/scene_gltf.h"

#include "core/error.h"
#include "formats/assimp_scene.h"
#include "formats/gltf_curves.h"

namespace paperbake {
namespace {

/// assimp's nodes in the order of copy_nodes, as indices of the file: both trees are one.
struct Pairing {
  const GltfCurves& curves;
  std::vector<int> index_of_copy;

  void add(const aiNode& node, int index) {
    index_of_copy.push_back(index);
    add_children(node, curves.children[index]);
  }
  void add_children(const aiNode& node, const std::vector<int>& children) {
    if (node.mNumChildren != children.size()) throw std::runtime_error("its hierarchy is not a tree");
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(*node.mChildren[i], children[i]);
  }
};

}  // namespace

ImportedFile import_gltf(const std::filesystem::path& path) {
  const GltfCurves curves = read_gltf_curves(path);
  Assimp::Importer importer;
  const aiScene& scene = assimp_scene(importer, path, "glTF2");
  const bool real = curves.roots.size() == 1;  // else assimp puts a root of its own above
  Pairing pairing{curves, {}};
  if (real) pairing.add(*scene.mRootNode, curves.roots.front());
  else pairing.add_children(*scene.mRootNode, curves.roots);

  ImportedFile file;
  file.reader = "the file's samplers";
  file.to_z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  file.up_axis = "y up";
  std::map<int, int> copy_of_index;
  copy_nodes(*scene.mRootNode, real, file, [&](const aiNode&, int copy) { copy_of_index.emplace(pairing.index_of_copy.at(copy), copy); });
  copy_meshes(scene, file);
  for (const Take& take : curves.takes) {
    Take& moved = file.takes.emplace_back();
    moved.name = take.name;
    for (const auto& [index, motion] : take.motions)
      if (const auto copy = copy_of_index.find(index); copy != copy_of_index.end()) moved.motions.emplace(copy->second, motion);
  }
  return file;
}

}  // namespace paperbake
