#pragma once

#include "core/geometry/point_location.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// How much of an edge with this fold is a crease: 0 below 0.4 rad, 1 beyond 0.8 rad, smooth
/// between, so that nothing pops while paper is folded. theta [rad], any sign. returns [1]
double crease_share(double theta);

/// The curved sheet that a coarse mesh stands for: one quadratic patch for each triangle, with
/// common edges.
///
///   x(b) = sum_i b_i c_i + sum_{i<j} b_i b_j d_ij,   d_ij = 1/2 (1 - s) (e^T S e) n
///
/// c  corner, drawn in by half of what the patches round it stand out (a polyline of true lengths
///    lies outside its arc)
/// e  edge ij on the pattern;  S  developable curvature tensor, mean of the two ends;  n  unit
///    normal there (no more than 0.8 rad along an edge: a needle's folds over its small area tell
///    of any curvature)
/// s  crease_share of the edge: a crease stays straight and sharp, and what lies beyond it has no
///    say in S and n
///
/// source  algorithm E2.3 "b1 + shift"; patches with common edges and soft creases are this
///         project's
struct CurvedSurface {
  Triangles triangles;
  Points3 corners;    // |V|x3   [m]
  Points3 bulge;      // 3|T|x3  [m] d of the edge opposite corner i of triangle t in row 3t + i
  Points3 curvature;  // |V|x3   [1/m] S: Sxx, Sxy, Syy

  /// The surface at a place; weights may lie outside [0, 1], where a finer border does.
  Vector3d at(const MeshPoint&) const;
};

/// exact  vertices that are not drawn in: handles
CurvedSurface curve(const Sheet&, const std::vector<int>& exact = {});

}  // namespace paperbake
