#pragma once

#include "core/model/sheet.h"

#include <utility>
#include <vector>

namespace paperbake {

/// The creases of a mesh, to be found again along the edges of other meshes of the same pattern.
class CreasesOfMesh {
 public:
  /// creases  edges (two vertices)
  CreasesOfMesh(const Points2& pattern, const std::vector<std::pair<int, int>>& creases);

  /// How far each crease is one at least. [1] empty: no edge is remembered
  /// It is what is remembered of an edge that runs along it: in nearly the same direction, within a
  /// twentieth of its length from the middle of the crease. A fine mesh has rows of vertices along
  /// it that are not exactly on it.
  /// pattern  of the mesh whose edges are remembered
  std::vector<double> least_shares(const Points2& pattern,
                                   const std::vector<RememberedCrease>&) const;

 private:
  struct Crease {
    Vector2d middle;  // [m]
    Vector2d along;   // of length 1
    std::size_t number;
  };
  std::vector<Crease> creases_;  // in the order of x
};

}  // namespace paperbake
