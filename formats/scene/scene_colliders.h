#pragma once

#include "core/geometry/collider.h"
#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Whether a node is a collider: it has a mesh and is not a sheet, and it or an empty above it is
/// named collider... or has the property paper_collider. An empty does not make colliders of
/// handles and creases below it, nor of a mesh whose paper_collider says no.
/// throws Error(ErrorCode::scene) for a paper_collider that is not understood
bool is_collider(const SceneNodes&, int node);

/// Reads the colliders of a scene, in order of the file. A collider has all faces of its node,
/// welded, where node, blend shapes and bones put them in every frame, and the friction coefficient
/// paper_friction, else that of paper on wood. The property paper_collider may also be "inside" or
/// "outside", which says where the paper stays. What a mesh does not say itself, the empty says
/// that makes it a collider. Adds warnings of what is not followed, such as caches, and of what is
/// meant as a collider but has no faces.
/// throws Error(ErrorCode::scene) for an invalid property
std::vector<ColliderMesh> read_colliders(const SceneNodes&, std::vector<std::string>& warnings);

}  // namespace paperbake
