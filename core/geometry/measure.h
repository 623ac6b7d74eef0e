#pragma once

#include "core/model/segment2.h"
#include "core/model/sheet.h"

#include <cmath>

namespace paperbake {

/// The edge of a sheet whose length is most wrong.
struct WorstEdge {
  double error = 0;      // [1] |l - L|/L
  Vector2d where{0, 0};  // [m] its midpoint on the pattern
};
WorstEdge worst_edge(const Sheet&);

/// How well a sheet keeps the edge lengths of its pattern. It takes several times as long as
/// worst_edge().
struct LengthDistortion {
  double mean = 0;       // [1] c_m: mean over the edges of |l - L|/L, [Schreck 2015] table 2
  double largest = 0;    // [1] largest |l - L|/L
  Vector2d where{0, 0};  // [m] midpoint of the worst edge on the pattern
};
LengthDistortion length_distortion(const Sheet&);

/// Relative elongation (l - L)/L of the most stretched edge, at least 0. [1]
double largest_stretch(const Sheet&);

/// Longer side of the box around a pattern that has vertices. [m]
inline double longer_side(const Points2& pattern) {
  return (pattern.colwise().maxCoeff() - pattern.colwise().minCoeff()).maxCoeff();
}

/// Mean edge length on the pattern; an edge counts once for each triangle it belongs to. [m]
double mean_edge(const Points2& pattern, const Triangles&);

/// Area of triangle t on the pattern. [m2]
inline double pattern_area(const Sheet& sheet, int t) {
  const auto corner = [&](int i) -> Vector2d { return sheet.pattern.row(sheet.triangles(t, i)); };
  return signed_area(corner(0), corner(1), corner(2));
}

/// Unit normal of the triangle a, b, c, which is counter-clockwise seen from where it points to; 0
/// if the triangle has no area. (vertex_normals() asks for more precision where one is tiny.)
inline Vector3d triangle_normal(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (b - a).cross(c - a).normalized();
}

/// Angle between two vectors, from 0 to pi. [rad]
inline double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Angle from a to b about a unit vector that is normal to both, in (-pi, pi]. [rad]
inline double angle_about(const Vector3d& axis, const Vector3d& a, const Vector3d& b) {
  const double sine = a.cross(b).dot(axis) + 0.0;  // no -0, of which the angle would be -pi
  return std::atan2(sine, a.dot(b));
}

/// Largest |2 pi - sum of angles| over the inner vertices that are not singular points: 0 for a
/// developable surface. [rad]
double angle_defect_max(const Sheet&);

/// Unit normals of the vertices: the triangle normals, weighted by the angles at the vertex. |V|x3
Points3 vertex_normals(const Points3& x, const Triangles&);

/// Root mean square of the distances between corresponding points, of which there is one at least.
/// [m]
double rms_distance(const Points3& a, const Points3& b);

/// Length of the longest row; 0 for no rows.
inline double max_row_norm(const Points3& d) {
  return d.rows() ? std::sqrt(d.rowwise().squaredNorm().maxCoeff()) : 0;
}

}  // namespace paperbake
