#pragma once

#include "formats/scene_file.h"

#include <filesystem>
#include <string>

namespace paperbake {

/// What is in a scene file, where each value came from, and what is wrong with it; as text for people or as JSON.
/// throws Error(Fault::scene) as read_scene does
std::string inspect_scene(const std::filesystem::path&, const SceneOptions&, bool json);

/// frame,node,x,y,z of every node and bone at every whole frame; world, z up, metres.
std::string tracks_csv(const std::filesystem::path&, const SceneOptions&);

}  // namespace paperbake
