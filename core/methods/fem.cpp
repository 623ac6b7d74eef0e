#include "core/methods/fem.h"

#include "core/geometry/pattern_mesh.h"

namespace paperbake {
namespace {

class Fem : public Method {
 public:
  explicit Fem(const FirstLattice& lattice) : lattice_(lattice) {}

  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    return mesh_pattern_with(pattern, lattice_.triangles, points, lattice_.turn);
  }
  std::optional<PatternMesh> mesh_with_creases(const Pattern& pattern,
                                               const std::vector<Vector2d>& points,
                                               int refinement) const override {
    return try_mesh_pattern(pattern, equilateral_edge(pattern, refinement * lattice_.triangles),
                            points, lattice_.turn);
  }

 private:
  FirstLattice lattice_;
};

}  // namespace

MethodChoice fem(const FirstLattice& lattice) {
  return {"fem", [=] { return std::make_unique<Fem>(lattice); }};
}

}  // namespace paperbake
