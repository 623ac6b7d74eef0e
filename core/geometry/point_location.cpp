#include "core/geometry/point_location.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

/// Finds the point on the edges of a triangle that is nearest to p: sets its barycentric weights
/// and returns its squared distance. [m2]
double nearest_in_triangle(const Vector2d& p, const Vector2d (&corner)[3], Vector3d& weights) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vector2d &a = corner[i], &b = corner[(i + 1) % 3];
    const double t = nearest_share(p, a, b);
    const double distance = (p - a - t * (b - a)).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    weights.setZero();
    weights[i] = 1 - t;
    weights[(i + 1) % 3] = t;
  }
  return least;
}

}  // namespace

PointLocator::PointLocator(const Points2& pattern, const Triangles& triangles)
    : pattern_(pattern), triangles_(triangles) {
  for (int v = 0; v < pattern.rows(); ++v) box_.extend(Vector2d(pattern.row(v)));
  const Vector2d size = box_.sizes();
  cell_ = std::max(std::sqrt(size.x() * size.y() / std::max<long>(1, triangles.rows())), 1e-12);
  columns_ = 1 + static_cast<int>(size.x() / cell_);
  rows_ = 1 + static_cast<int>(size.y() / cell_);
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
  const auto clamp_cell = [&](const Vector2d& p, int& c, int& r) {
    c = std::clamp(static_cast<int>((p.x() - box_.min().x()) / cell_), 0, columns_ - 1);
    r = std::clamp(static_cast<int>((p.y() - box_.min().y()) / cell_), 0, rows_ - 1);
  };
  for (int t = 0; t < triangles.rows(); ++t) {
    Eigen::AlignedBox2d box;
    for (int i = 0; i < 3; ++i) box.extend(Vector2d(pattern.row(triangles(t, i))));
    int c0, r0, c1, r1;
    clamp_cell(box.min(), c0, r0);
    clamp_cell(box.max(), c1, r1);
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c)
        cells_[static_cast<std::size_t>(r) * columns_ + c].push_back(t);
  }
}

bool PointLocator::inside(int t, const Vector2d& p, Vector3d& weights) const {
  constexpr double outside = -1e-9;
  weights = barycentric(p, pattern_.row(triangles_(t, 0)), pattern_.row(triangles_(t, 1)),
                        pattern_.row(triangles_(t, 2)));
  return weights.minCoeff() >= outside;
}

MeshPoint PointLocator::locate(const Vector2d& p) const {
  const int c = static_cast<int>(std::floor((p.x() - box_.min().x()) / cell_));
  const int r = static_cast<int>(std::floor((p.y() - box_.min().y()) / cell_));
  if (c >= 0 && r >= 0 && c < columns_ && r < rows_) {
    MeshPoint place;
    for (int t : cells_[static_cast<std::size_t>(r) * columns_ + c])
      if (inside(t, p, place.weights)) {
        place.triangle = t;
        return place;
      }
  }
  return nearest(p);
}

MeshPoint PointLocator::nearest(const Vector2d& p) const {
  MeshPoint best{0, Vector3d::Zero()};
  double least = std::numeric_limits<double>::infinity();
  for (int t = 0; t < triangles_.rows(); ++t) {
    Vector3d weights;
    if (inside(t, p, weights)) return {t, weights};
    const Vector2d corner[3] = {pattern_.row(triangles_(t, 0)), pattern_.row(triangles_(t, 1)),
                                pattern_.row(triangles_(t, 2))};
    const double distance = nearest_in_triangle(p, corner, weights);
    if (distance < least) {
      least = distance;
      best = {t, weights};
    }
  }
  return best;
}

Vector3d interpolate(const MeshPoint& place, const Triangles& triangles,
                     const Points3& per_vertex) {
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < 3; ++i)
    sum += place.weights[i] * per_vertex.row(triangles(place.triangle, i)).transpose();
  return sum;
}

}  // namespace paperbake
