#pragma once

#include "formats/scene/scene_import.h"

namespace paperbake {

/// A glTF 2 or GLB file: nodes, faces and properties of the scene that is shown, every animation as
/// its samplers have it (gltf_curves.h). throws Error(Fault::scene): damaged or foreign file;
/// std::exception: damaged, in words
ImportedFile import_gltf(const std::filesystem::path&);

}  // namespace paperbake
