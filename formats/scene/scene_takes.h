#pragma once

#include "formats/scene/scene_nodes.h"

#include <vector>

namespace paperbake {

/// Sets motions and shapes of a scene, with times in seconds: each node follows one take,
/// preferably one that moves it, then one that passes through its rest position, then the one with
/// most keys.
/// returns  the takes that are used
/// throws   Error(ErrorCode::scene) for an unknown take
std::vector<const Take*> merge_takes(SceneNodes&, const SceneOptions&);

}  // namespace paperbake
