#include "core/geometry/judged_colliders.h"

#include "core/geometry/rigid_motion.h"

#include <algorithm>

namespace paperbake {
namespace {

std::vector<ColliderMesh> meshes_of(const Colliders& colliders) {
  std::vector<ColliderMesh> meshes;
  for (const Collider& collider : colliders) meshes.push_back(collider.mesh());
  return meshes;
}

}  // namespace

JudgedColliders::JudgedColliders(const std::vector<ColliderMesh>& all) : meshes(all) {
  for (const ColliderMesh& mesh : meshes) depths_.emplace_back(mesh);
}

JudgedColliders::JudgedColliders(const Colliders& colliders)
    : JudgedColliders(meshes_of(colliders)) {}

Penetration JudgedColliders::deepest_in(std::size_t collider, int row, const Points3& x,
                                        const Triangles& triangles) const {
  const ColliderMesh& mesh = meshes[collider];
  if (mesh.frames.empty()) return depths_[collider].deepest(x, triangles);
  const int last = static_cast<int>(mesh.frames.size()) - 1;
  const Points3& now = mesh.frames[std::clamp(row, 0, last)];
  if (const auto back = rigid_motion_between(now, mesh.x, depth_exact_to / 20))
    return depths_[collider].deepest(moved(*back, x), triangles);
  ColliderMesh deformed = mesh;
  deformed.x = now;
  return ColliderDepth(deformed).deepest(x, triangles);
}

ColliderPenetration JudgedColliders::deepest(int row, const Points3& x,
                                             const Triangles& triangles) const {
  ColliderPenetration deepest;
  for (std::size_t c = 0; c < meshes.size(); ++c) {
    const Penetration found = deepest_in(c, row, x, triangles);
    if (found.depth > deepest.depth) {
      static_cast<Penetration&>(deepest) = found;
      deepest.collider = c;
    }
  }
  return deepest;
}

}  // namespace paperbake
