#pragma once

#include "core/model/air.h"
#include "formats/scene/scene_nodes.h"

#include <vector>

namespace paperbake {

/// Whether a node is a wind: it has no mesh, and is named wind, wind.002, wind_left, ..., or is
/// named wind... and has the property paper_speed.
bool is_wind(const ImportedNode&);

/// Reads the winds of a scene, in order of the file. A wind blows along the +y axis of its node in
/// glTF, which is +z in Blender, and along its +z axis in FBX, or along its paper_axis (x, -x, y,
/// ...), with paper_speed [m/s], 1 without it. Keys of the node turn it. Keys of its scale make it
/// rise and fall: it has its speed where the node is largest. paper_gust [1] and paper_seed are
/// Wind::gust and Wind::seed.
/// throws Error(ErrorCode::scene) for an invalid property
std::vector<Wind> read_winds(const SceneNodes&);

}  // namespace paperbake
