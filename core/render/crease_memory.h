#pragma once

#include "core/model/segment2.h"
#include "core/model/sheet.h"

#include <utility>
#include <vector>

namespace paperbake {

/// The creases of a mesh, to be found again along the edges of other meshes of the same pattern.
class CreasesOfMesh {
 public:
  /// creases  edges (two vertices)
  CreasesOfMesh(const Points2& pattern, const std::vector<std::pair<int, int>>& creases);

  /// How far each crease is one at least: it lies along an edge that is remembered
  /// (Sheet::remembered). [1] empty: none is
  std::vector<double> least_shares(const Sheet&) const;

 private:
  struct Crease {
    double x;  // [m] of its middle
    Segment2 line;
    std::size_t number;
  };
  std::vector<Crease> creases_;  // in the order of x
};

}  // namespace paperbake
