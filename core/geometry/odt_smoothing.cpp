#include "core/geometry/odt_smoothing.h"

#include "core/model/segment2.h"

#include <cmath>

namespace paperbake {

void smooth_points(const Triangles& triangles, std::vector<Vector2d>& points, int fixed) {
  std::vector<Vector2d> sum(points.size(), Vector2d::Zero()), centroid = sum;
  std::vector<double> weight(points.size(), 0.0);
  std::vector<char> obtuse(points.size(), 0);
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector2d a = points[triangles(t, 0)], b = points[triangles(t, 1)],
                   c = points[triangles(t, 2)];
    const Vector2d u = b - a, v = c - a;
    const double doubled = cross(u, v);
    const Vector2d centre = a + Vector2d(v.y() * u.squaredNorm() - u.y() * v.squaredNorm(),
                                         u.x() * v.squaredNorm() - v.x() * u.squaredNorm()) /
                                    (2 * doubled);
    const Vector2d middle = (a + b + c) / 3;
    const bool is_obtuse = (centre - middle).squaredNorm() > 0.25 * std::abs(doubled);
    for (int i = 0; i < 3; ++i) {
      const int p = triangles(t, i);
      sum[p] += 0.5 * doubled * centre;
      centroid[p] += 0.5 * doubled * middle;
      weight[p] += 0.5 * doubled;
      obtuse[p] |= is_obtuse;
    }
  }
  for (std::size_t p = static_cast<std::size_t>(fixed); p < points.size(); ++p)
    if (weight[p] > 0) points[p] = (obtuse[p] ? centroid[p] : sum[p]) / weight[p];
}

}  // namespace paperbake
