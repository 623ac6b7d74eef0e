#pragma once

#include "baker/job/settings.h"
#include "formats/scene/scene_file.h"

#include <filesystem>
#include <string>

namespace paperbake {

/// What is in a scene file, where each value came from, and what is wrong with it as a bake with
/// nothing else on its command line would say; as text for people or as JSON. throws as plan_bake
/// does
std::string inspect_scene(const std::filesystem::path&, const SceneOptions&, bool json);

/// The same of the scene of a job, with what the job says, and behind it every value that a bake
/// would use and who said it. throws as plan_bake does
std::string inspect_job(const BakeSettings&, bool json);

/// What an artist wants to know of a cache that was baked: sheets, frames, meshes, channels, size.
/// throws Error(ErrorCode::scene) as AlembicReader does
std::string inspect_cache(const std::filesystem::path&, bool json);

/// frame,node,x,y,z of every node and bone at every whole frame; world, z up, metres.
std::string tracks_csv(const std::filesystem::path&, const SceneOptions&);

}  // namespace paperbake
