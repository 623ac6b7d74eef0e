#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// A point on a pattern mesh: a triangle and the barycentric weights of its three corners.
struct MeshPoint {
  int triangle;
  // [1] sum 1, each in [0, 1]; outside the mesh those of the nearest point of the mesh
  Vector3d weights;
};

/// Finds the triangle of a pattern mesh that contains a given point, by a uniform grid of cells.
/// Keeps copies of the pattern and the triangles.
class PointLocator {
 public:
  PointLocator(const Points2& pattern, const Triangles&);
  /// The mesh point at p; outside the mesh, the nearest one.
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

/// Value at a mesh point of a quantity given at the vertices (|V|x3).
Vector3d interpolate(const MeshPoint&, const Triangles&, const Points3& per_vertex);

}  // namespace paperbake
