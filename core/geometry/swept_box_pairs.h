#pragma once

#include "core/model/sheet.h"

#include <array>
#include <utility>
#include <vector>

namespace paperbake {

/// Finds the triangles of a sheet that come near each other, and says which vertices and edges each
/// of them answers for, so that every pair of features is met in exactly one pair of triangles.
/// source [Curtis 2008] for the latter
class SweptBoxPairs {
 public:
  explicit SweptBoxPairs(const Triangles&);

  /// Pairs a < b whose boxes, swept from x to x + move and grown by `margin` [m] on all sides,
  /// overlap; in no order that depends on anything else. move: |V|x3 [m]
  const std::vector<std::pair<int, int>>& find(const Points3& x, const Points3& move,
                                               double margin);

  /// Corners 0-2 of a triangle that it answers for, and edges: bit i of `edges` is the edge
  /// opposite corner i.
  struct Owned {
    unsigned char corners = 0, edges = 0;
  };
  const std::vector<Owned>& owned() const { return owned_; }

 private:
  Triangles triangles_;
  std::vector<Owned> owned_;
  // by the low end along the axis of the last sweep: nearly sorted for the next one
  std::vector<int> order_;
  std::vector<std::array<double, 6>> box_;  // low x y z, high x y z
  std::vector<std::pair<int, int>> pairs_;
};

}  // namespace paperbake
