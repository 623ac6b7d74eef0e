#pragma once

#include "core/model/sheet.h"

#include <array>
#include <vector>

namespace paperbake {

/// The closest points of two features that have four corners together: a vertex and a triangle, or
/// two edges.
struct ClosestPoints {
  // separation = sum_i weights_i corner_i; the weights of the first feature add up to 1, those of
  // the second to -1
  Eigen::Vector4d weights;
  Vector3d apart;  // [m] from the closest point of the second feature to that of the first
  double distance() const { return apart.norm(); }
};

/// Corner 0 against the triangle of corners 1, 2, 3. source [Ericson 2005], 5.1.5
ClosestPoints vertex_to_triangle(const std::array<Vector3d, 4>& corners);

/// Edge 0-1 against edge 2-3; either may have zero length. source [Ericson 2005], 5.1.9
ClosestPoints edge_to_edge(const std::array<Vector3d, 4>& corners);

using TriangleCorners = std::array<Vector3d, 3>;  // [m]
TriangleCorners corners_of(const Points3& x, const Triangles&, int triangle);

/// [m] The least distance of a feature of one triangle from one of the other, also where they
/// intersect.
double feature_distance(const TriangleCorners&, const TriangleCorners&);

/// True when the edge p-q passes through the interior of the triangle. Touching does not count.
bool pierces(const Vector3d& p, const Vector3d& q, const TriangleCorners&);
/// True when an edge of triangle s or t of a mesh passes through the interior of the other one.
/// Edges that begin or end at a common corner do not count.
bool pierce_each_other(const Points3& x, const Triangles&, int s, int t);

/// Tests whether part of a sheet may change its shape without passing through the rest of it. The
/// volume swept by an edge flip, or by a vertex that moves, consists of tetrahedra; this tests one.
///
/// vertices  vertex numbers of the tetrahedron's corners; -1: not a vertex of the mesh yet
/// corners   [m] positions of these corners
/// changing  triangles that take part in the change and are ignored
/// returns   true when nothing else of the sheet lies within the tetrahedron, and no other edge is
///           closer than `clearance` [m] to its edge 2-3
bool tetrahedron_is_empty(const Sheet&, const std::array<int, 4>& vertices,
                          const std::array<Vector3d, 4>& corners, const std::vector<int>& changing,
                          double clearance);

}  // namespace paperbake
