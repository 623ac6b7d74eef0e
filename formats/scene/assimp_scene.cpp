#include "formats/scene/assimp_scene.h"

#include "core/model/error.h"
#include "formats/scene/scene_properties.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>

#include <fmt/format.h>

#include <charconv>
#include <cstdint>

namespace paperbake {
namespace {

Eigen::Affine3d transform(const aiMatrix4x4& m) {
  Eigen::Affine3d t = Eigen::Affine3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) t(row, column) = m[row][column];
  return t;
}

std::optional<PropertyValue> property(const aiMetadataEntry& entry) {
  const auto as = [&](auto* type) { return *static_cast<decltype(type)>(entry.mData); };
  switch (entry.mType) {
    case AI_BOOL:
      return as(static_cast<bool*>(nullptr)) ? 1.0 : 0.0;
    case AI_INT32:
      return double(as(static_cast<std::int32_t*>(nullptr)));
    case AI_UINT64:
      return double(as(static_cast<std::uint64_t*>(nullptr)));
    case AI_FLOAT:
      return as_typed(as(static_cast<float*>(nullptr)));
    case AI_DOUBLE:
      return as(static_cast<double*>(nullptr));
    case AI_AISTRING:
      return text_or_list(static_cast<aiString*>(entry.mData)->C_Str());
    case AI_AIVECTOR3D: {
      const auto* v = static_cast<aiVector3D*>(entry.mData);
      return std::vector<double>{as_typed(v->x), as_typed(v->y), as_typed(v->z)};
    }
    default:
      return std::nullopt;
  }
}

void copy_node(const aiNode& node, int parent, ImportedFile& file,
               const std::function<void(const aiNode&, int)>& copied) {
  ImportedNode copy;
  copy.name = node.mName.C_Str();
  copy.parent = parent;
  copy.local = transform(node.mTransformation);
  if (!copy.local.matrix().allFinite())
    throw Error(ErrorCode::scene, fmt::format("node \"{}\"", copy.name),
                "Its transform contains a value that is not a number.");
  copy.meshes.assign(node.mMeshes, node.mMeshes + node.mNumMeshes);
  for (unsigned i = 0; node.mMetaData && i < node.mMetaData->mNumProperties; ++i)
    if (const auto value = property(node.mMetaData->mValues[i]))
      copy.properties.emplace(node.mMetaData->mKeys[i].C_Str(), *value);
  const int index = static_cast<int>(file.nodes.size());
  file.nodes.push_back(std::move(copy));
  copied(node, index);
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    copy_node(*node.mChildren[i], index, file, copied);
}

ImportedMesh copy_mesh(const aiMesh& mesh) {
  const auto where = [&] { return fmt::format("mesh \"{}\"", mesh.mName.C_Str()); };
  ImportedMesh copy;
  copy.deformed = mesh.mNumBones > 0 || mesh.mNumAnimMeshes > 0;
  if (copy.deformed) copy.not_followed = "The deformation";
  copy.x.resize(mesh.mNumVertices, 3);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) copy.x.row(i) = vector(mesh.mVertices[i]);
  bool finite = copy.x.allFinite();
  for (unsigned n = 0; n < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh.HasTextureCoords(n); ++n) {
    AuthoredAttribute& set = copy.attributes.emplace_back();
    const aiString* name = mesh.GetTextureCoordsName(n);
    set.name = name && name->length > 0 ? name->C_Str() : fmt::format("UVChannel_{}", n + 1);
    set.kind = AttributeKind::uv;
    set.values.resize(mesh.mNumVertices, 2);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i)
      set.values.row(i) = vector(mesh.mTextureCoords[n][i]).head<2>();
    finite = finite && set.values.allFinite();
  }
  for (unsigned n = 0; n < AI_MAX_NUMBER_OF_COLOR_SETS && mesh.HasVertexColors(n); ++n) {
    AuthoredAttribute& set = copy.attributes.emplace_back();
    set.name = n == 0 ? "Color" : fmt::format("Color.{:03}", n);  // assimp drops their names
    set.kind = AttributeKind::colour;
    set.values.resize(mesh.mNumVertices, 4);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiColor4D& at = mesh.mColors[n][i];
      set.values.row(i) << at.r, at.g, at.b, at.a;
    }
    finite = finite && set.values.allFinite();
  }
  if (!finite)
    throw Error(ErrorCode::scene, where(), "A vertex contains a value that is not a number.");
  std::vector<int> corners;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices)
        throw Error(ErrorCode::scene, where(), "A face refers to a vertex that does not exist.");
      corners.push_back(static_cast<int>(face.mIndices[k]));
    }
  }
  copy.triangles =
      Eigen::Map<Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return copy;
}

}  // namespace

Vector3d vector(const aiVector3D& v) { return {v.x, v.y, v.z}; }

double as_typed(float f) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, f).ptr;
  double value = f;
  std::from_chars(text, end, value);
  return value;
}

const aiScene& assimp_scene(Assimp::Importer& importer, const std::filesystem::path& path,
                            const std::string& format) {
  // without pivots the rotations about Maya's pivots are lost, as the test file
  // maya_anim_pivot_rotate shows
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
  if (!scene || !scene->mRootNode)
    throw Error(ErrorCode::scene, path.string(),
                fmt::format("The file cannot be read: {}", importer.GetErrorString()),
                export_again);
  aiString found;
  if (scene->mMetaData) scene->mMetaData->Get("SourceAsset_Format", found);
  if (std::string(found.C_Str()).find(format) == std::string::npos) throw foreign_file(path);
  return *scene;
}

void copy_nodes(const aiNode& root, ImportedFile& file,
                const std::function<void(const aiNode&, int)>& copied) {
  for (unsigned i = 0; i < root.mNumChildren; ++i) copy_node(*root.mChildren[i], -1, file, copied);
}

void copy_meshes(const aiScene& scene, ImportedFile& file) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i)
    file.meshes.push_back(copy_mesh(*scene.mMeshes[i]));
}

}  // namespace paperbake
