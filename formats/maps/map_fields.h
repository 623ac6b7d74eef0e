#pragma once

#include "formats/maps/map_raster.h"

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

/// The vertices in texels, with their fields.
std::vector<FieldCorner> field_corners(const MapFields&, double side, int size);

/// A texel outside the mesh, and the nearest point of its border: at a fraction t of an edge.
struct BorderTexel {
  int index, edge;
  double t;
};
/// Those of the texels marked in `open`, as for_each_texel() needs them.
std::vector<BorderTexel> texels_beside(const MapFields&,
                                       const std::vector<std::vector<Vector2d>>& loops,
                                       const std::vector<FieldCorner>&, const MapRows&,
                                       const std::vector<char>& open);

/// Calls texel(index, fields) once for every wanted texel of the rows, with the fields at its
/// centre, interpolated linearly in the triangle there; outside the mesh those of the nearest point
/// of its border, at any distance.
/// side    [m] longer side of the pattern
/// loops   [texel] corners of the pattern's outline and holes; a coarse mesh may stay behind them
/// wanted  one entry for each texel of the rows
/// texel   index as MapRows::index
template <class Texel>
void for_each_texel(const MapFields& fields, double side,
                    const std::vector<std::vector<Vector2d>>& loops, const MapRows& rows,
                    const std::vector<char>& wanted, const Texel& texel) {
  const std::vector<FieldCorner> corner = field_corners(fields, side, rows.size);
  std::vector<char> open = wanted;
  for (int t = 0; t < fields.triangles.rows(); ++t)
    for_each_in_triangle({corner[fields.triangles(t, 0)], corner[fields.triangles(t, 1)],
                          corner[fields.triangles(t, 2)]},
                         rows, [&](int i, int row, const Fields& f) {
                           const int index = rows.index(i, row);
                           if (!open[index]) return;
                           open[index] = 0;
                           texel(index, f);
                         });
  for (const BorderTexel& beside : texels_beside(fields, loops, corner, rows, open)) {
    const auto [a, b] = fields.border[beside.edge];
    texel(beside.index,
          Fields(fields.of_vertex[a] + beside.t * (fields.of_vertex[b] - fields.of_vertex[a])));
  }
}

/// The texels that a filtered lookup inside the pattern may read: those that overlap the pattern,
/// and those whose centre is at most map_padding texels from its border.
/// coverage  of area_coverage
inline constexpr int map_padding = 4;
std::vector<char> wanted_texels(const std::vector<std::vector<Vector2d>>& loops,
                                const std::vector<float>& coverage, const MapRows&);

}  // namespace paperbake
