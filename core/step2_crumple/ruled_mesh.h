#pragma once

#include "core/step2_crumple/rulings.h"

#include <optional>
#include <vector>

namespace paperbake {

/// The base mesh of a sheet, from which all of its ruled meshes are derived.
struct BaseMesh {
  Pattern polygons;             // [m] the border, reduced to its corners
  std::vector<Vector2d> inner;  // [m] vertices in the interior
  double h = 0;                 // [m] mean edge length
  double least_altitude = 0;    // [m] of its triangles
  int triangles = 0;            // number of triangles
};
BaseMesh base_mesh(const Points2& pattern, const Triangles&);

/// A mesh that has rulings among its edges.
struct RuledMesh {
  Points2 pattern;      // |V|x2 [m] the required points first
  Triangles triangles;  // |T|x3 counter-clockwise
};

/// Builds a mesh with the rulings among its edges. Its vertices are the required and the singular
/// points, the corners, points that divide the rulings into equal parts, points on the border
/// between them, and the points of the base mesh where there is no ruling.
/// required        [m] points that become the vertices 0, 1, ...
/// singular        [m] singular points
/// keep_out_discs  where all points of the base mesh stay
/// returns         nothing when there is no sound mesh: edges would cross, or a triangle would be
///                 a needle, narrower than those of the base mesh
std::optional<RuledMesh> ruled_mesh(const BaseMesh&, const std::vector<Vector2d>& required,
                                    const std::vector<Vector2d>& singular,
                                    const std::vector<Ruling>&,
                                    const std::vector<Disc>& keep_out_discs, const RulingOptions&);

}  // namespace paperbake
