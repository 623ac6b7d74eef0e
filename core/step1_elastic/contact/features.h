#pragma once

#include "core/geometry/proximity.h"

#include <array>

namespace paperbake {

/// What two features that may collide are, which have four corners together.
enum class Features {
  vertex_and_triangle,  // corner 0, corners 1-2-3
  two_edges             // corners 0-1, corners 2-3
};

/// The first corner of the second feature.
inline int second_of(Features features) { return features == Features::two_edges ? 2 : 1; }

/// The closest points of two features with their corners at x [m].
inline ClosestPoints closest_points(const std::array<Vector3d, 4>& x, Features features) {
  return features == Features::two_edges ? edge_to_edge(x) : vertex_to_triangle(x);
}

}  // namespace paperbake
