#pragma once

#include "core/render/render_mesh.h"

namespace paperbake {

/// Divides every triangle into four: the middles of edges become vertices, numbered after the
/// others.
struct Subdivision {
  struct Middle {
    int a, b;  // the ends of the edge
    // numbers of the normals at a on either side; the same number twice where there is no crease
    int normal_a[2];
    int normal_b[2];
  };
  RenderMesh mesh;
  std::vector<Middle> middles;

  /// Positions on the finer mesh. A middle lies on the curve that leaves both ends at right angles
  /// to their normals, so that what was smooth stays smooth; the middle of a crease is the mean of
  /// what its two sides give.
  ///
  ///   m = (x_a + x_b)/2 - ( ((x_b - x_a).n_a) n_a + ((x_a - x_b).n_b) n_b )/8
  ///
  /// x        |V|x3 [m]
  /// normals  unit, numbered as of_corner says
  /// returns  |V'|x3 [m]
  /// source   [Vlachos 2001]: the middle of an edge of a PN triangle
  Points3 positions(const Points3& x, const Points3& normals) const;
};

/// of_corner  |T|x3 number of the normal at each corner
Subdivision subdivide(const RenderMesh&, const Triangles& of_corner);

}  // namespace paperbake
