#include "core/methods/method.h"

#include "core/geometry/pattern_mesh.h"

namespace paperbake {

Method fem(int triangles, double turn) {
  Method method;
  method.name = "fem";
  method.first_mesh = [=](const Pattern& pattern, const std::vector<Vector2d>& points) {
    PatternMesh mesh = mesh_pattern_with(pattern, triangles, points, turn);
    return Method::FirstMesh{std::move(mesh.vertices), std::move(mesh.triangles),
                             std::move(mesh.point_vertex)};
  };
  return method;
}

}  // namespace paperbake
