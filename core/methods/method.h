#pragma once

#include "core/pattern.h"
#include "core/sheet.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// All that differs between methods: what the first mesh is, and what happens to the sheet after each elastic step. The
/// elastic solver, handles, time step, tolerances and timers are the same for all and live in `animate`.
struct Method {
  std::string name;

  /// Mesh of the pattern in which every point is a vertex. point_vertex[i]: the vertex of points[i].
  struct FirstMesh {
    Points2 pattern;
    Triangles triangles;
    std::vector<int> point_vertex;
  };
  std::function<FirstMesh(const Pattern&, const std::vector<Vector2d>& points)> first_mesh;

  /// May change positions and mesh of the sheet. returns true when the mesh changed. Empty: nothing happens.
  std::function<bool(Sheet&)> after_step;
};

/// Standard finite elements: step 1 alone on a fixed mesh of about `triangles` near-equilateral triangles.
Method fem(int triangles);

}  // namespace paperbake
