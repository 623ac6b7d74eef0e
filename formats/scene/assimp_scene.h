#pragma once

#include "formats/scene/scene_import.h"

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include <functional>

namespace paperbake {

/// The scene of a file, with its faces split into triangles; it lives as long as the importer.
/// format  the only one accepted, by its assimp name: "FBX"
/// throws  Error(ErrorCode::scene) at `path` when assimp cannot read it or it has another format
const aiScene& assimp_scene(Assimp::Importer&, const std::filesystem::path& path,
                            const std::string& format);

/// Copies all nodes below a node, parents before children, in order of the file, and calls
/// copied(node, index) after each. throws Error(ErrorCode::scene) at a node with a number that is
/// not finite
void copy_nodes(const aiNode& root, ImportedFile&,
                const std::function<void(const aiNode&, int)>& copied);

/// Copies all meshes in order. throws Error(ErrorCode::scene) at a mesh with a number that is not
/// finite, or a face with a vertex that does not exist
void copy_meshes(const aiScene&, ImportedFile&);

Vector3d vector(const aiVector3D&);

/// The double whose shortest decimal is that of the 32-bit number: a 0.002 typed by the artist
/// stays 0.002.
double as_typed(float);

}  // namespace paperbake
