#include "core/geometry/judged_colliders.h"

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
  for (const ColliderMesh& mesh : meshes)
    depths.push_back(mesh.frames.empty() ? std::make_shared<const ColliderDepth>(mesh) : nullptr);
}

JudgedColliders::JudgedColliders(const Colliders& colliders)
    : JudgedColliders(meshes_of(colliders)) {}

ColliderPenetration JudgedColliders::deepest(int row, const Points3& x,
                                             const Triangles& triangles) const {
  std::vector<std::shared_ptr<const ColliderDepth>> now = depths;
  for (std::size_t c = 0; c < now.size(); ++c) {
    if (now[c]) continue;
    const auto& frames = meshes[c].frames;
    ColliderMesh mesh = meshes[c];
    mesh.x = frames[std::clamp(row, 0, static_cast<int>(frames.size()) - 1)];
    now[c] = std::make_shared<const ColliderDepth>(mesh);
  }
  return deepest_penetration(now, x, triangles);
}

}  // namespace paperbake
