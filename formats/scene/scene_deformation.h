#pragma once

#include "formats/scene/scene_nodes.h"

#include <vector>

namespace paperbake {

/// The vertices of all meshes of a node at a frame, one mesh after the other, as blend shapes and
/// then bones move them. |V|x3 [m] in the world
/// world  of every node at this frame (scene_nodes.h)
Points3 vertices_at(const SceneNodes&, int node, const std::vector<Eigen::Affine3d>& world,
                    int frame);

}  // namespace paperbake
