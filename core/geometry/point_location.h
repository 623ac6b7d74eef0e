#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// A place on a pattern mesh: triangle and barycentric weights of its three corners.
struct MeshPoint {
  int triangle;
  // sum 1; within [0, 1] unless the point lies outside the mesh, then those of the nearest triangle
  Vector3d weights;
};

/// Finds the triangle of a pattern mesh under a point, by a grid of cells. Keeps a copy of what it
/// needs.
class PointLocator {
 public:
  PointLocator(const Points2& pattern, const Triangles&);
  /// Outside the mesh: the nearest triangle, with the weights of the nearest point on it.
  MeshPoint locate(const Vector2d& p) const;

 private:
  bool inside(int triangle, const Vector2d& p, Vector3d& weights) const;
  MeshPoint nearest(const Vector2d& p) const;

  Points2 pattern_;
  Triangles triangles_;
  Eigen::AlignedBox2d box_;
  double cell_;
  int columns_, rows_;
  std::vector<std::vector<int>> cells_;
};

/// Value at a place of a quantity given per vertex (|V|x3).
Vector3d interpolate(const MeshPoint&, const Triangles&, const Points3& per_vertex);

}  // namespace paperbake
