#pragma once

#include "core/model/pattern.h"

#include <vector>

namespace paperbake {

/// A triangulation of the pattern.
struct PatternMesh {
  Points2 vertices;               // |V|x2 [m]
  Triangles triangles;            // |T|x3 counter-clockwise
  std::vector<int> point_vertex;  // which vertex each required point became; equal points share one
};

/// Lines that were folded are rows of edges; their vertices are in point_vertex, behind those of
/// the points. Near-equilateral triangles: rows of a lattice along the longest side of the outline,
/// the border in equal parts, and every required point a vertex; smoothed where lattice, border and
/// points meet.
/// edge    [m] aimed at
/// points  [m] inside the pattern or on its border
/// turn    [rad] of the lattice against the longest side
/// border  [edges] borders finer than an edge are followed to this
/// throws Error(Fault::scene) when the outline crosses or touches itself
PatternMesh mesh_pattern(const Pattern&, double edge, const std::vector<Vector2d>& points,
                         double turn = 0, double border = 0.02);

/// The same with about `triangles` triangles (within 10 % where the outline and the points leave
/// that choice).
PatternMesh mesh_pattern_with(const Pattern&, int triangles, const std::vector<Vector2d>& points,
                              double turn = 0);

/// Renumbers the vertices so that the required points come first, in the order of the points.
/// returns  how many vertices they are
int number_points_first(PatternMesh&);

}  // namespace paperbake
