#pragma once

#include "formats/scene/gltf_file.h"
#include "formats/scene/scene_import.h"

#include <vector>

namespace paperbake {

/// The animations of a glTF file, motions by node index of the file: STEP, LINEAR and CUBICSPLINE
/// samplers on translation, rotation and scale of nodes, of floats or normalized integers. throws
/// Error(Fault::scene) at the node: a key that is no number; std::exception, in words: damaged.
/// source: glTF 2.0
std::vector<Take> gltf_takes(GltfFile&);

}  // namespace paperbake
