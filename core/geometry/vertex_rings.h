#pragma once

#include "core/geometry/hinges.h"

#include <vector>

namespace paperbake {

/// What lies around each vertex of a mesh.
struct VertexRings {
  VertexRings(const Triangles&, const Hinges&, long vertices);

  std::vector<std::vector<int>> triangles;  // |V| those with a corner at the vertex
  std::vector<std::vector<int>> hinges;     // |V| the inner edges that end at the vertex
  std::vector<char> border;                 // |V| 1: the vertex lies on the border
};

/// Length of the longest edge at a vertex, on the pattern. [m]
double ring_size(const Sheet&, const VertexRings&, int vertex);

}  // namespace paperbake
