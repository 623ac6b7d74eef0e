#include "core/geometry/rest_triangle.h"

#include <Eigen/LU>

namespace paperbake {

RestTriangle rest_triangle(const Points2& pattern, const Eigen::RowVector3i& corners) {
  const Vector2d p0 = pattern.row(corners[0]), p1 = pattern.row(corners[1]),
                 p2 = pattern.row(corners[2]);
  Eigen::Matrix2d edges;
  edges << p1 - p0, p2 - p0;
  const Eigen::Matrix2d inverse = edges.inverse();
  RestTriangle rest;
  rest.area = 0.5 * edges.determinant();
  rest.g.row(1) = inverse.row(0);
  rest.g.row(2) = inverse.row(1);
  rest.g.row(0) = -rest.g.row(1) - rest.g.row(2);
  return rest;
}

}  // namespace paperbake
