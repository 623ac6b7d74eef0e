#pragma once

#include "formats/maps/map_raster.h"

#include <functional>
#include <utility>
#include <vector>

namespace paperbake {

/// The quantities of a sheet's shape that a map shows, at the vertices of its mesh.
struct MapFields {
  Points2 pattern;  // |V|x2 [m]
  Triangles triangles;
  // |V| four tensors Sxx, Sxy, Syy each: curvature [1/m], fold angle [rad], plastic fold angle
  // [rad], Green strain [1]
  std::vector<Fields> of_vertex;
  std::vector<std::pair<int, int>> border;  // ends of the edges with one triangle
};

/// Evaluates the fields of a sheet. Strain is averaged over the triangles around a vertex, weighted
/// by area: the strains of single triangles alternate in sign, because a constant-strain triangle
/// is stiffer than paper.
/// curvature   |V|x3 [1/m], of core/geometry/curvature
/// plastic     |V|x3 [1/m], or empty for none
/// fold_width  [m] see fold_width.h
MapFields map_fields(const Sheet&, const Points3& curvature, const Points3& plastic,
                     double fold_width);

/// Calls texel(index, fields) once for every wanted texel of the rows, with the fields at its
/// centre, interpolated linearly in the triangle there; outside the mesh those of the nearest point
/// of its border, at any distance.
/// side    [m] longer side of the pattern
/// loops   [texel] corners of the pattern's outline and holes; a coarse mesh may stay behind them
/// wanted  one entry for each texel of the rows
/// texel   index as MapRows::index
void for_each_texel(const MapFields&, double side, const std::vector<std::vector<Vector2d>>& loops,
                    const MapRows&, const std::vector<char>& wanted,
                    const std::function<void(int, const Fields&)>& texel);

/// The texels that a filtered lookup inside the pattern may read: those that overlap the pattern,
/// and those whose centre is at most map_padding texels from its border.
/// coverage  of area_coverage
inline constexpr int map_padding = 4;
std::vector<char> wanted_texels(const std::vector<std::vector<Vector2d>>& loops,
                                const std::vector<float>& coverage, const MapRows&);

}  // namespace paperbake
