#pragma once

#include "formats/scene/scene_import.h"

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include <functional>

namespace paperbake {

/// The scene of a file, faces as triangles; it lives as long as the importer. throws
/// Error(Fault::scene) at `path`: assimp cannot read it, or its format is not the one named ("FBX")
const aiScene& assimp_scene(Assimp::Importer&, const std::filesystem::path& path,
                            const std::string& format);

/// Copies what is below a node, parents before children, in order of the file. `copied` is told of
/// each node and its index. throws Error(Fault::scene) at the node: a number that is none
void copy_nodes(const aiNode& root, ImportedFile&,
                const std::function<void(const aiNode&, int)>& copied);

/// All meshes, in order. throws Error(Fault::scene) at the mesh: a number that is none, a face with
/// a vertex that does not exist
void copy_meshes(const aiScene&, ImportedFile&);

Vector3d vector(const aiVector3D&);

/// The shortest decimal that the 32-bit number stands for: 0.002 typed by the artist stays 0.002.
double as_typed(float);

}  // namespace paperbake
