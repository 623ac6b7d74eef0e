#pragma once

#include "formats/scene_import.h"

namespace paperbake {

/// A glTF 2 or GLB file: nodes, meshes and properties by assimp, every animation as its samplers have it (gltf_curves.h).
/// throws Error(Fault::scene): damaged or foreign file; std::exception: damaged, in words
ImportedFile import_gltf(const std::filesystem::path&);

}  // namespace paperbake
