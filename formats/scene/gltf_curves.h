#pragma once

#include "formats/scene/gltf_file.h"
#include "formats/scene/scene_import.h"

#include <vector>

namespace paperbake {

/// Reads the animations of a glTF file, with motions by the file's own node index: STEP, LINEAR and
/// CUBICSPLINE samplers of floats or normalized integers for translation, rotation and scale.
/// throws  Error(ErrorCode::scene) at a node with a key that is not finite;
///         Damage or Json::exception for a damaged file
/// source  glTF 2.0
std::vector<Take> gltf_takes(GltfFile&);

}  // namespace paperbake
