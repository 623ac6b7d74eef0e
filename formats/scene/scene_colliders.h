#pragma once

#include "core/geometry/collider.h"
#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Whether a node is a collider: it has a mesh, is named collider... or has the property
/// paper_collider, and is not a sheet.
bool is_collider(const ImportedNode&);

/// Reads the colliders of a scene, in order of the file. A collider has all faces of its node,
/// welded, where node, blend shapes and bones put them in every frame, and the friction coefficient
/// paper_friction, else that of paper on wood. The property paper_collider may also be "inside" or
/// "outside", which says where the paper stays. Adds warnings of what is not followed: caches, and
/// meshes without faces.
/// throws Error(ErrorCode::scene) for an invalid property
std::vector<ColliderMesh> read_colliders(const SceneNodes&, std::vector<std::string>& warnings);

}  // namespace paperbake
