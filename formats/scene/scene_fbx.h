#pragma once

#include "formats/scene/scene_import.h"

namespace paperbake {

/// Reads a binary or ASCII FBX file, with ufbx where the build has it (scene_fbx_ufbx.cpp), else
/// with assimp (scene_fbx_assimp.cpp). ufbx evaluates curves as the DCC does, with steps, tangents,
/// layers and extrapolation; the tracks then hold the values at whole frames.
/// fps     [1/s] rate of these frames, default: that of the file
/// throws  Error(ErrorCode::scene) for a damaged file or one of another format
ImportedFile import_fbx(const std::filesystem::path&, std::optional<double> fps);

}  // namespace paperbake
