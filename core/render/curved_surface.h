#pragma once

#include "core/geometry/point_location.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// How far an edge with this dihedral angle is a crease: 0 below 0.4 rad, 1 above 0.8 rad, and
/// smooth between them, so that nothing jumps while paper is being folded.
/// theta    [rad] of either sign
/// returns  [1]
double crease_share(double theta);
constexpr double crease_begins = 0.4;  // [rad] dihedral angle up to which that is 0
constexpr double whole_crease = 0.8;   // [rad] and from which on it is 1

/// The curved sheet that a coarse mesh stands for: one quadratic patch for each triangle, with the
/// same curve on both sides of every edge.
///
///   x(b) = sum_i b_i c_i + sum_{i<j} b_i b_j d_ij,   d_ij = 1/2 (1 - s) (e^T S e) n
///
/// c  corner, drawn in by half of the mean height of the patches around it (a polyline of true
///    lengths lies outside its arc)
/// e  edge ij on the pattern
/// S  developable curvature tensor, mean of the two ends; limited to a turn of 0.8 rad along an
///    edge, because the dihedral angles of a needle over its small area may give any curvature
/// n  unit normal at the edge, mean of the two ends
/// s  crease_share of the edge, or what is remembered of it where that is more: a crease stays
///    straight and sharp, and what lies beyond it does not contribute to S and n
///
/// source  this project
struct CurvedSurface {
  Triangles triangles;
  Points3 corners;    // |V|x3   [m]
  Points3 bulge;      // 3|T|x3  [m] d of the edge opposite corner i of triangle t in row 3t + i
  Points3 curvature;  // |V|x3   [1/m] S: Sxx, Sxy, Syy

  /// A point of the surface. Its weights may lie outside [0, 1], where a finer border lies outside
  /// the mesh.
  Vector3d at(const MeshPoint&) const;
};

/// exact  vertices that are not drawn in: handles
CurvedSurface curve(const Sheet&, const std::vector<int>& exact = {});

}  // namespace paperbake
