#pragma once

#include "formats/maps/map_raster.h"

#include <functional>
#include <utility>
#include <vector>

namespace paperbake {

/// What a map shows of the shape of a sheet, at the vertices of its mesh.
struct MapFields {
  Points2 pattern;  // |V|x2 [m]
  Triangles triangles;
  // |V| curvature [1/m], fold [rad], plastic fold [rad], Green strain [1]: Sxx, Sxy, Syy each
  std::vector<Fields> of_vertex;
  std::vector<std::pair<int, int>> border;  // vertices of the edges with one triangle
};

/// curvature  |V|x3 [1/m], of core/curvature
/// plastic    |V|x3 [1/m], or empty: 0
/// fold_width [m] of rolled paper; folds: fold_width.h Strain is that of the triangles around a
/// vertex, weighted by area: a triangle alone is stiffer than paper and strains in turns with its
/// neighbours.
MapFields map_fields(const Sheet&, const Points3& curvature, const Points3& plastic,
                     double fold_width);

/// Calls texel(index, fields) once for every wanted texel of the rows (indices as MapRows::index):
/// the fields at its centre, linear in the triangle there; outside the mesh those of the nearest
/// point of its border, whatever the distance.
/// loops   [texel] of the pattern; they bound how far a mesh may stay behind it
/// wanted  one for each texel of the rows
void for_each_texel(const MapFields&, double side, const std::vector<std::vector<Vector2d>>& loops,
                    const MapRows&, const std::vector<char>& wanted,
                    const std::function<void(int, const Fields&)>& texel);

/// The texels that a lookup inside the pattern may touch: those with any part of it in them, and
/// those with their centre at most map_padding texels from its border.
inline constexpr int map_padding = 4;
std::vector<char> wanted_texels(const std::vector<std::vector<Vector2d>>& loops,
                                const std::vector<float>& coverage, const MapRows&);

}  // namespace paperbake
