#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <utility>
#include <vector>

namespace paperbake {

/// A straight fold on the pattern.
struct CreaseSegment {
  Vector2d a, b;      // [m]
  double weight = 1;  // [1] who comes first where there are too many
};

/// What the mesh for a whole shot has to show.
struct RenderFeatures {
  // [m] vertices: handles, the rims of their discs, singular points
  std::vector<Vector2d> points;
  std::vector<CreaseSegment> creases;
  // of meshes that were simulated: rows of edges, to a millionth of the sheet
  std::vector<CreaseSegment> edges = {};
};

/// One mesh of the pattern for all frames of a shot.
struct RenderMesh {
  Points2 pattern;      // |V|x2 [m]
  Triangles triangles;  // |T|x3 counter-clockwise
  // which vertex each point became; those nearer than 0.3 edges may share one
  std::vector<int> point_vertex;
  // edges (smaller vertex first, sorted) along which it may fold sharply
  std::vector<std::pair<int, int>> creases;
  // of the pattern: creases however little they turn
  std::vector<PrescribedCrease> prescribed_creases = {};
  bool along_edges = false;  // it has the simulated edges
};

/// Near-equilateral triangles of this edge; the border as fine as a thousandth of it; every point a
/// vertex. A crease is a row of points 2/3 of an edge apart, ends and crossings with other creases
/// among them, so that the Delaunay triangulation has most edges between them of itself; where one
/// is missing an edge is turned, down to angles of 8 degrees. Beside the border they keep 0.15
/// edges away from it. Points of creases nearer than 0.3 edges to others become one with them: no
/// needles where creases cross or run side by side. Creases beyond half a metre for each square
/// decimetre and millimetre of edge [area / (2 edge)] are left out, the weightiest last. Simulated
/// edges, when there are any, are rows of edges exactly, whatever the angles between them, and
/// creases run along them. Where there are more than 6 m for each square metre and metre of edge,
/// or some that cross within a millionth of the sheet, it has none of them. throws
/// Error(Fault::scene) when the outline crosses or touches itself
RenderMesh mesh_for_render(const Pattern&, double edge, const RenderFeatures&);

/// The same with edges as much longer as it takes to have no more triangles than that.
RenderMesh mesh_for_render(const Pattern&, double edge, const RenderFeatures&, int max_triangles);

}  // namespace paperbake
