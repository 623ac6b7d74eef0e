#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <utility>
#include <vector>

namespace paperbake {

/// A straight crease on the pattern.
struct CreaseSegment {
  Vector2d a, b;      // [m]
  double weight = 1;  // [1] where there is no room for all, the heaviest come first
};

/// What the mesh for a whole shot has to represent.
struct RenderFeatures {
  // [m] points that become vertices: handles, the rims of their discs, singular points
  std::vector<Vector2d> points;
  std::vector<CreaseSegment> creases;
  // false: smooth paper, which is sharp along its prescribed creases alone, however coarse the
  // triangles that it was simulated on
  bool may_crease = true;
  // prescribed creases that are folded in the shot; they take the place of those of the pattern
  std::vector<PrescribedCrease> prescribed_creases = {};
  // edges of simulated meshes: they become rows of edges, to a millionth of the sheet
  std::vector<CreaseSegment> edges = {};
  // where uv sets or materials of the sheet jump: rows of edges as well, where there is room
  std::vector<CreaseSegment> seams = {};
  // where other attributes jump: the same, and the first that are left out
  std::vector<CreaseSegment> jumps = {};
};

/// What became of the simulated edges that a render mesh was to have.
enum class SimulatedEdges {
  none,      // there are none
  kept,      // they are among the edges of the mesh
  too_long,  // left out: there is no room for their total length
  too_close  // left out: some cross so near to others that no triangulation has them all
};

/// One mesh of the pattern for all frames of a shot.
struct RenderMesh {
  Points2 pattern;      // |V|x2 [m]
  Triangles triangles;  // |T|x3 counter-clockwise
  // vertex of each point; points nearer than 0.3 edges to each other may share one
  std::vector<int> point_vertex;
  // edges (smaller vertex first, sorted) along which the mesh may fold sharply
  std::vector<std::pair<int, int>> creases;
  // prescribed creases, sharp however small their angle
  std::vector<PrescribedCrease> prescribed_creases = {};
  SimulatedEdges simulated_edges = SimulatedEdges::none;
};

/// Triangulates the pattern into near-equilateral triangles with edges of this length [m]. The mesh
/// follows the border to a thousandth of it, and every point is a vertex.
///
/// A crease becomes a row of points 2/3 of an edge apart, which includes its ends and its crossings
/// with other creases. The Delaunay triangulation has most edges between these points of itself;
/// where one is missing an edge is flipped, down to angles of 8 degrees. Points of a crease that
/// runs along the border keep 0.15 edges away from it. Points nearer than 0.3 edges to those of
/// other creases are merged with them, and those that near to a prescribed crease move onto it, so
/// that there are no needles where creases cross or run side by side. Creases beyond a total length
/// of area / (2 edge) [m] are left out, the lightest first.
///
/// Simulated edges, if there are any, become rows of edges exactly, whatever the angles between
/// them, and so do the creases that do not lie beside them. They are all left out when their total
/// length exceeds 6 area / edge [m], or when some cross within a millionth of the sheet;
/// `simulated_edges` says so. Seams become rows of edges like simulated edges, and all of them are
/// left out where these would be.
///
/// Where lines cross beside each other, edges shorter than 0.02 edges are merged, so that lines
/// have their vertices up to that far beside them.
/// throws  Error(ErrorCode::simulation) when no triangulation has all its points and creases:
///         some are too near to each other or to the border
RenderMesh mesh_for_render(const Pattern&, double edge, const RenderFeatures&);

/// The same, with edges as much longer as it takes to have no more triangles than that.
RenderMesh mesh_for_render(const Pattern&, double edge, const RenderFeatures&, int max_triangles);

}  // namespace paperbake
