#pragma once

#include "core/geometry/collider_depth.h"

#include <cstddef>
#include <vector>

namespace paperbake {

/// The colliders of a scene as they are judged. Each is prepared for exact depths once; one that
/// has turned and shifted as a whole is judged where it was first, with the sheet moved there. Only
/// where it has another shape it is prepared again.
struct JudgedColliders {
  explicit JudgedColliders(const std::vector<ColliderMesh>&);
  explicit JudgedColliders(const Colliders&);

  /// row  frame - first frame of the scene
  ColliderPenetration deepest(int row, const Points3& x, const Triangles&) const;

  std::vector<ColliderMesh> meshes;

 private:
  Penetration deepest_in(std::size_t collider, int row, const Points3& x, const Triangles&) const;

  std::vector<ColliderDepth> depths_;  // in the first frame
};

}  // namespace paperbake
