#pragma once

#include "core/model/pattern.h"

#include <optional>
#include <vector>

namespace paperbake {

/// A triangle mesh of the pattern.
struct PatternMesh {
  Points2 vertices;               // |V|x2 [m]
  Triangles triangles;            // |T|x3 counter-clockwise
  std::vector<int> point_vertex;  // vertex of each required point; equal points share one
};

/// Whether a vertex is that of a required point. |V|
std::vector<char> are_required(const PatternMesh&);

/// Edge of the equilateral triangles of which so many have the area of the pattern. [m]
double equilateral_edge(const Pattern&, int triangles);

/// Meshes the pattern with nearly equilateral triangles: rows of a lattice along the longest side
/// of the outline, the border in equal parts, every required point a vertex; smoothed where
/// lattice, border and points meet. Prescribed creases become rows of edges; their vertices follow
/// those of the required points in point_vertex.
/// edge    [m] desired edge length
/// points  [m] required points, inside the pattern or on its border
/// turn    [rad] angle of the lattice against the longest side
/// border  [1] tolerance, in edge lengths, within which a border with finer detail is followed
/// throws  Error(ErrorCode::scene) when the outline crosses or touches itself
PatternMesh mesh_pattern(const Pattern&, double edge, const std::vector<Vector2d>& points,
                         double turn = 0, double border = 0.02);

/// The same, but returns nothing where mesh_pattern throws, and where prescribed creases cross so
/// near to others that no triangulation has them all.
std::optional<PatternMesh> try_mesh_pattern(const Pattern&, double edge,
                                            const std::vector<Vector2d>& points, double turn = 0,
                                            double border = 0.02);

/// The same with about `triangles` triangles (within 10 %, where the outline and the points leave
/// that choice).
PatternMesh mesh_pattern_with(const Pattern&, int triangles, const std::vector<Vector2d>& points,
                              double turn = 0);

/// Renumbers the vertices so that the required points come first, in their own order.
/// returns  number of vertices that the required points became
int number_points_first(PatternMesh&);

}  // namespace paperbake
