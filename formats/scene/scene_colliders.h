#pragma once

#include "core/geometry/collider.h"
#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// A node with a mesh that is named `collider...` or has the property paper_collider; no sheet.
bool is_collider(const ImportedNode&);

/// The colliders of a scene, in order of the file: all faces of a node, welded, where they are at
/// the first frame, and how the node carries them from there, rigidly; paper_friction, else that of
/// paper on wood. Warns of keyed sizes, bones and meshes without faces, which are not followed.
/// throws Error(Fault::scene): a bad property
std::vector<ColliderMesh> read_colliders(const SceneNodes&, std::vector<std::string>& warnings);

}  // namespace paperbake
