#include "core/geometry/collider_gap.h"

#include "core/geometry/box_of.h"

#include <algorithm>
#include <vector>

namespace paperbake {

std::optional<ColliderGap> gap_around(const ColliderShapes& colliders, const Vector3d& p,
                                      double widest) {
  constexpr double opposite = -0.966;  // [1] cosine between the normals of the two faces
  constexpr int front = 1;
  std::vector<SurfacePoint> faces;
  for (const auto& collider : colliders) {
    std::vector<int> triangles;
    collider->triangle_tree().visit(grown(Eigen::AlignedBox3d(p), widest),
                                    [&](int t) { triangles.push_back(t); });
    std::sort(triangles.begin(), triangles.end());
    for (const SurfacePoint& face : collider->nearest(p, triangles, front)) faces.push_back(face);
  }
  std::optional<ColliderGap> narrowest;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (faces[i].normal.dot(faces[j].normal) > opposite) continue;
      const double width = faces[i].distance + faces[j].distance;
      if (width > 0 && width <= (narrowest ? narrowest->width : widest))
        narrowest = {width, (faces[i].normal - faces[j].normal).normalized()};
    }
  return narrowest;
}

}  // namespace paperbake
