#include "core/methods/method.h"

#include "core/pattern_mesh.h"

#include <memory>

namespace paperbake {

Method hybrid(const Pattern& pattern, const Paper& paper, int base_triangles, const CrumpleOptions& options, std::uint32_t seed,
              std::uint32_t sheet) {
  Method method;
  method.name = "hybrid";
  method.first_mesh = [base_triangles](const Pattern& cut, const std::vector<Vector2d>& points) {
    PatternMesh mesh = mesh_pattern_with(cut, base_triangles, points);
    return Method::FirstMesh{std::move(mesh.vertices), std::move(mesh.triangles), std::move(mesh.point_vertex)};
  };
  const auto crumple = std::make_shared<Crumple>(pattern, paper, options, seed, sheet);
  method.remesh = [crumple](Sheet& sheet_now, const std::vector<char>& fixed, int frame, bool moving) {
    return crumple->operate(sheet_now, fixed, frame, moving).mesh_changed();
  };
  return method;
}

}  // namespace paperbake
