#include "core/hinges.h"

#include "core/error.h"

#include <cmath>
#include <unordered_map>

namespace paperbake {

Hinges find_hinges(const Triangles& triangles) {
  struct Side {
    int triangle, corner;
  };
  Hinges result;
  result.of_triangle.assign(triangles.rows(), {-1, -1, -1});
  std::unordered_map<std::uint64_t, Side> open;
  open.reserve(2 * triangles.rows());
  const auto key = [](std::uint32_t a, std::uint32_t b) { return (std::uint64_t(a) << 32) | b; };
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = triangles(t, (i + 1) % 3), b = triangles(t, (i + 2) % 3);
      const auto twin = open.find(key(b, a));
      if (twin == open.end()) {
        if (!open.emplace(key(a, b), Side{t, i}).second)
          throw Error(Fault::simulation, "mesh", "An edge of the mesh has more than two triangles, or two with opposite sides up.");
        continue;
      }
      const auto [other, corner] = twin->second;
      result.of_triangle[other][corner] = result.of_triangle[t][i] = static_cast<int>(result.hinges.size());
      result.hinges.push_back({{b, a, triangles(other, corner), triangles(t, i)}, {other, t}});
      open.erase(twin);
    }
  return result;
}

double fold_angle(const Points3& x, const Hinge& hinge) {
  const auto at = [&](int k) -> Vector3d { return x.row(hinge.vertices[k]); };
  const Vector3d x0 = at(0), e = at(1) - x0;
  const Vector3d left = e.cross(at(2) - x0), right = (at(3) - x0).cross(e);
  // both arguments carry |left||right|: the normals need not be unit
  return std::atan2(left.cross(right).dot(e) / e.norm(), left.dot(right));
}

}  // namespace paperbake
