#include "core/methods/fem.h"

#include "core/geometry/pattern_mesh.h"

namespace paperbake {
namespace {

class Fem : public Method {
 public:
  explicit Fem(const FirstLattice& lattice) : lattice_(lattice) {}

  FirstMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    PatternMesh mesh = mesh_pattern_with(pattern, lattice_.triangles, points, lattice_.turn);
    return {std::move(mesh.vertices), std::move(mesh.triangles), std::move(mesh.point_vertex)};
  }
  std::optional<FirstMesh> mesh_with_creases(const Pattern& pattern,
                                             const std::vector<Vector2d>& points) const override {
    std::optional<PatternMesh> mesh = try_mesh_pattern(
        pattern, equilateral_edge(pattern, lattice_.triangles), points, lattice_.turn);
    if (!mesh) return std::nullopt;
    return FirstMesh{std::move(mesh->vertices), std::move(mesh->triangles),
                     std::move(mesh->point_vertex)};
  }

 private:
  FirstLattice lattice_;
};

}  // namespace

MethodChoice fem(const FirstLattice& lattice) {
  return {"fem", [=] { return std::make_unique<Fem>(lattice); }};
}

}  // namespace paperbake
