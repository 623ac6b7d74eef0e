#pragma once

#include "core/model/sheet.h"

#include <array>
#include <utility>
#include <vector>

namespace paperbake {

/// Finds the pairs of triangles of a sheet that come near each other (the broad phase of contact).
/// It also makes one triangle responsible for each vertex and each edge, so that every pair of
/// features occurs in exactly one pair of triangles.
/// source [Curtis 2008] for these responsibilities
class SweptBoxPairs {
 public:
  explicit SweptBoxPairs(const Triangles&);

  /// Pairs a < b whose boxes overlap when they are swept from x to x + move and enlarged by
  /// `margin` [m] on all sides; the order depends on the mesh and these arguments alone.
  /// x, move  |V|x3 [m]
  const std::vector<std::pair<int, int>>& find(const Points3& x, const Points3& move,
                                               double margin);

  /// The features for which a triangle is responsible: bit i of `corners` is corner i, bit i of
  /// `edges` the edge opposite corner i.
  struct Owned {
    unsigned char corners = 0, edges = 0;
  };
  const std::vector<Owned>& owned() const { return owned_; }

 private:
  Triangles triangles_;
  std::vector<Owned> owned_;
  // by the lower end along the axis of the last sweep, so nearly sorted for the next one
  std::vector<int> order_;
  std::vector<std::array<double, 6>> box_;  // lower x y z, upper x y z
  std::vector<std::pair<int, int>> pairs_;
};

}  // namespace paperbake
