#pragma once

#include "core/geometry/collider_depth.h"

#include <memory>
#include <vector>

namespace paperbake {

/// The colliders of a scene as they are judged. Those that stand still are prepared for exact
/// depths once.
struct JudgedColliders {
  explicit JudgedColliders(const std::vector<ColliderMesh>&);
  explicit JudgedColliders(const Colliders&);

  /// row  frame - first frame of the scene
  ColliderPenetration deepest(int row, const Points3& x, const Triangles&) const;

  std::vector<ColliderMesh> meshes;
  std::vector<std::shared_ptr<const ColliderDepth>> depths;  // null for those that move
};

}  // namespace paperbake
