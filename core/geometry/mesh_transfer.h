#pragma once

#include "core/geometry/point_location.h"

namespace paperbake {

/// Interpolates quantities given at the vertices of one mesh of a pattern to other points of it,
/// such as the vertices of another mesh; linear in each triangle.
class MeshTransfer {
 public:
  /// to  |W|x2 [m] points of the pattern at which values are wanted
  MeshTransfer(const Points2& pattern, const Triangles&, const Points2& to);
  Points3 operator()(const Points3& per_vertex) const;  // |V|x3 -> |W|x3

 private:
  Triangles triangles_;
  std::vector<MeshPoint> places_;
};

/// A sheet on another mesh of its pattern: positions and velocities are interpolated; singular
/// points and prescribed creases belong to the paper and stay as they are. Points and creases that
/// are to be vertices and edges must be so in the mesh that is given.
Sheet on_other_mesh(const Sheet&, Points2 pattern, Triangles);
/// The same where what carries the values is there already.
/// onto  from the mesh of the sheet to `pattern`
Sheet on_other_mesh(const Sheet&, Points2 pattern, Triangles, const MeshTransfer& onto);

}  // namespace paperbake
