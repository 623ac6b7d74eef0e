#pragma once

#include "core/geometry/point_location.h"

namespace paperbake {

/// Carries what the vertices of one mesh of a pattern know over to the vertices of another,
/// linearly in each triangle.
class MeshTransfer {
 public:
  /// to  |W|x2 [m] points of the pattern that ask
  MeshTransfer(const Points2& pattern, const Triangles&, const Points2& to);
  Points3 operator()(const Points3& per_vertex) const;  // |V|x3 -> |W|x3

 private:
  Triangles triangles_;
  std::vector<MeshPoint> places_;
};

}  // namespace paperbake
