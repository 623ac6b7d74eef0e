#pragma once

#include "core/model/sheet.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace paperbake {

/// A side of a triangle.
struct TriangleSide {
  int triangle, corner;  // it lies opposite this corner
  bool forwards;         // the triangle runs along it from the lower vertex to the higher
};

/// An edge of a mesh with the sides of triangles that lie on it, in order of triangle and corner:
/// one at the border, two inside, more where the mesh is no surface.
struct MeshEdge {
  int low, high;  // its ends, the vertex with the lower number first
  const TriangleSide *first, *last;

  const TriangleSide* begin() const { return first; }
  const TriangleSide* end() const { return last; }
  std::size_t size() const { return last - first; }
  const TriangleSide& operator[](std::size_t k) const { return first[k]; }
};

/// All edges of a mesh, each once, in ascending order of their lower and then their higher vertex.
/// Any triangles will do; where they must be those of a sheet, Hinges (hinges.h) has its inner
/// edges in the order in which they are found.
class MeshEdges {
 public:
  explicit MeshEdges(const Triangles&);
  MeshEdges(const MeshEdges&) = delete;
  MeshEdges& operator=(const MeshEdges&) = delete;

  std::vector<MeshEdge>::const_iterator begin() const { return edges_.begin(); }
  std::vector<MeshEdge>::const_iterator end() const { return edges_.end(); }
  std::size_t size() const { return edges_.size(); }

 private:
  std::vector<TriangleSide> sides_;
  std::vector<MeshEdge> edges_;  // point into sides_
};

/// The edges with one triangle, each from its start to its end: the mesh lies on its left. Those
/// that start at the same vertex, where a border touches itself, are in ascending order.
std::vector<std::pair<int, int>> border_of(const MeshEdges&);

}  // namespace paperbake
