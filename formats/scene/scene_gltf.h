#pragma once

#include "formats/scene/scene_import.h"

namespace paperbake {

/// Reads a glTF 2 or GLB file: nodes, faces and properties of its default scene, and all animations
/// (gltf_curves.h).
/// throws Error(ErrorCode::scene) for a file of another format, or at a node that cannot be used;
/// Damage or Json::exception for a damaged file
ImportedFile import_gltf(const std::filesystem::path&, Parts);

}  // namespace paperbake
