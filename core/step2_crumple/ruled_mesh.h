#pragma once

#include "core/step2_crumple/rulings.h"

#include <optional>
#include <vector>

namespace paperbake {

/// What all meshes of one sheet have in common with its first.
struct BaseMesh {
  Pattern polygons;             // [m] the border with no more corners than it needs
  std::vector<Vector2d> inner;  // [m] vertices inside
  double h = 0;                 // [m] mean length of the edges
  int triangles = 0;
};
BaseMesh base_mesh(const Points2& pattern, const Triangles&);

struct RuledMesh {
  Points2 pattern;      // |V|x2 [m] the required points first
  Triangles triangles;  // |T|x3 counter-clockwise
};

/// A mesh with the rulings among its edges: required and singular points, corners, rulings in equal
/// parts, the border between them, and the base mesh's points where there is no ruling.
/// required  [m] points that become the vertices 0, 1, ...
/// guards    where all the points of the base mesh stay
/// returns   nothing when there is no sound mesh: edges would cross, or a triangle be a needle
std::optional<RuledMesh> ruled_mesh(const BaseMesh&, const std::vector<Vector2d>& required,
                                    const std::vector<Vector2d>& singular,
                                    const std::vector<Ruling>&,
                                    const std::vector<Disc>& keep_out_discs, const RulingOptions&);

}  // namespace paperbake
