#pragma once

#include "formats/scene_import.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// What a glTF file says of its nodes and their motion, by node index: names need not tell nodes apart.
struct GltfCurves {
  std::vector<int> roots;                  // of the scene that is shown
  std::vector<std::vector<int>> children;  // per node, each below the number of nodes; rings are possible
  std::vector<Take> takes;                 // motions by node index of the file
};

/// Reads animations of a .gltf or .glb file: STEP, LINEAR and CUBICSPLINE samplers on translation, rotation and scale, of floats or
/// normalized integers, in the file, in data URIs and in files beside it. Nothing in the file is trusted.
/// throws Error(Fault::scene) at the node: a key that is no number; at the file: a compression that is not read
/// throws std::runtime_error or nlohmann::json::exception, in words: damaged. source: glTF 2.0
GltfCurves read_gltf_curves(const std::filesystem::path&);

}  // namespace paperbake
