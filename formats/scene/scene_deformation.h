#pragma once

#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Whether bones, blend shapes or a cache deform a mesh of a node.
bool is_deformed(const ImportedFile&, const ImportedNode&);

/// Which of these deformations of a node is not followed, in words; empty: all are.
std::string not_followed(const ImportedFile&, const ImportedNode&);

/// The vertices of all meshes of a node at a frame, one mesh after the other, as blend shapes and
/// then bones move them. |V|x3 [m] in the world
/// world  of every node at this frame (scene_nodes.h)
Points3 vertices_at(const SceneNodes&, int node, const std::vector<Eigen::Affine3d>& world,
                    int frame);

}  // namespace paperbake
