#pragma once

#include "formats/scene/scene_import.h"

namespace paperbake {

/// An FBX file, binary or ASCII: by ufbx where the build has it (scene_fbx_ufbx.cpp), else by
/// assimp (scene_fbx_assimp.cpp). ufbx evaluates curves as the DCC does - steps, tangents, layers,
/// extrapolation - and the tracks hold the values at whole frames. fps: rate of these frames; none:
/// the file's throws Error(Fault::scene): damaged or foreign file
ImportedFile import_fbx(const std::filesystem::path&, std::optional<double> fps);

}  // namespace paperbake
