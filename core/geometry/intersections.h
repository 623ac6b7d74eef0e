#pragma once

#include "core/geometry/injective_patches.h"
#include "core/model/sheet.h"

#include <utility>
#include <vector>

namespace paperbake {

/// Finds the pairs of triangles of a mesh that intersect, for one frame after the other. Touching
/// in a shared vertex or edge does not count. The result is exact, and independent of the contact
/// code of the solver.
///
/// A hierarchy of boxes is made once, by halving the mesh on its pattern again and again; a frame
/// fills in the boxes and looks at the pairs of triangles whose boxes overlap. Parts of the sheet
/// that are proved not to intersect themselves (injective_patches.h) need no look.
class CrossingCounter {
 public:
  CrossingCounter(const Points2& pattern, const Triangles&);
  /// Their number.
  /// x  |V|x3 [m]. May be called by several threads at the same time.
  int operator()(const Points3& x) const;
  /// Their numbers, in an order that depends on the mesh alone.
  std::vector<std::pair<int, int>> pairs(const Points3& x) const;

 private:
  struct Search;
  struct Node {
    int begin, end;  // triangles
    int second;      // number of the second child; the first is the next node; -1: a leaf
    InjectivePatches::Cells cells;  // of its triangles
  };
  int build(const Points2& middles, int begin, int end);
  std::vector<int> order_;  // of the triangles, leaf by leaf
  Triangles triangles_;     // in that order
  std::vector<Node> nodes_;
  InjectivePatches patches_;
};

/// The same for one frame.
int crossings(const Sheet&);
/// For two sheets: pairs with one triangle from each.
int crossings_between(const Sheet&, const Sheet&);

}  // namespace paperbake
