#pragma once

#include "core/model/sheet.h"

#include <array>
#include <vector>

namespace paperbake {

/// The nearest points of two features with four corners together: a vertex and a triangle, or two
/// edges.
struct ClosestPoints {
  // apart = sum_i weights_i corner_i; the first feature's add up to 1, the second's to -1
  Eigen::Vector4d weights;
  Vector3d apart;  // [m] from the nearest point of the second feature to that of the first
  double distance() const { return apart.norm(); }
};

/// corner 0 against the triangle of corners 1, 2, 3. source [Ericson 2005], 5.1.5
ClosestPoints vertex_to_triangle(const std::array<Vector3d, 4>& corners);

/// edge 0-1 against edge 2-3; either may have no length. source [Ericson 2005], 5.1.9
ClosestPoints edge_to_edge(const std::array<Vector3d, 4>& corners);

/// The edge p-q passes through the inside of the triangle. Touching does not count.
bool pierces(const Vector3d& p, const Vector3d& q, const std::array<Vector3d, 3>& triangle);

/// Asks whether a part of a sheet may take another shape without passing through the rest of it.
/// What a flip, or a vertex that moves, sweeps over is made of tetrahedra.
///
/// vertices  corners that belong to the mesh; -1: a point that is new
/// corners   [m] where they are
/// changing  triangles that are part of the change: not looked at
/// returns   nothing else of the sheet lies within the tetrahedron or nearer than `clearance` [m]
///           to its edge 2-3
bool tetrahedron_is_empty(const Sheet&, const std::array<int, 4>& vertices,
                          const std::array<Vector3d, 4>& corners, const std::vector<int>& changing,
                          double clearance);

}  // namespace paperbake
