#pragma once

#include "formats/maps/fold_width.h"
#include "formats/maps/map_raster.h"

#include <utility>
#include <vector>

namespace paperbake {

/// The quantities of a sheet's shape that a map shows, at one place: four tensors Sxx, Sxy, Syy
/// each, the curvature [1/m], the turn of the smooth paper [rad], that of its plastic curvature
/// [rad], and Green strain [1].
using Fields = Eigen::Array<double, 12, 1>;
inline constexpr int of_curvature = 0, of_fold = 3, of_plastic_fold = 6, of_strain = 9;

/// The same at the vertices of the mesh of a sheet.
struct MapFields {
  Points2 pattern;  // |V|x2 [m]
  Triangles triangles;
  std::vector<Fields> of_vertex;  // |V|
  std::vector<SharpFold> sharp;
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

/// The vertices. [texel]
std::vector<Vector2d> vertices_in_texels(const MapFields&, double side, int size);

/// A texel outside the mesh, and the nearest point of its border: at a fraction t of an edge.
struct BorderTexel {
  int index, edge;
  double t;
};
/// Those of the texels marked in `open`, as for_each_texel_row() needs them.
/// vertices  [texel]
std::vector<BorderTexel> texels_beside(const MapFields&,
                                       const std::vector<std::vector<Vector2d>>& loops,
                                       const std::vector<Vector2d>& vertices, const MapRows&,
                                       const std::vector<char>& open);

/// Some neighbouring texels of a row, and some of the fields there.
template <int count>
struct TexelRow {
  static constexpr int longest = 64;
  int index;                     // of the first one, as MapRows::index
  int texels;                    // how many there are
  const char* wanted;            // of each; what it is 0 for is not to be drawn
  float fields[count][longest];  // of each field, of each texel: twice as fast as in 64 bits

  /// As many texels as fill whole registers: there are numbers for those beyond the last one too,
  /// which mean nothing. Loops over them have no rest that is done texel by texel.
  int padded() const { return (texels + 7) / 8 * 8; }
};

// [texel] of a line or disc: a thinner one would be lost between the centres of texels
inline constexpr double min_line_radius = 0.75;

/// [0, 1] part of a texel that a line or disc of this radius covers, taking its border there as
/// straight. radius, distance [texel]
inline double cover(double radius, double distance) {
  return std::clamp(radius + 0.5 - distance, 0.0, 1.0);
}

struct FoldScale {
  double side, fold_width;  // [m] longer side of the pattern; see fold_width.h
};
/// Calls texel(i, row, SharpFold, covered) for every texel of the rows that is within half a fold
/// width of a crease of this frame; covered: [0, 1] which part of it.
template <class Texel>
void for_each_sharp_texel(const MapFields& fields, const FoldScale& scale, const MapRows& rows,
                          const Texel& texel) {
  const double radius = std::max(min_line_radius, 0.5 * scale.fold_width / scale.side * rows.size);
  const auto at = [&](int v) { return to_texels(fields.pattern.row(v), scale.side, rows.size); };
  for (const SharpFold& fold : fields.sharp)
    for_each_near_segment(at(fold.ends[0]), at(fold.ends[1]), radius + 0.5, rows,
                          [&](int i, int row, double distance, double) {
                            texel(i, row, fold, static_cast<float>(cover(radius, distance)));
                          });
}

/// Calls texel_row(TexelRow<count>) so that every wanted texel of the rows is in one of them once
/// where its `wanted` is 1, with the fields first ... first + count - 1 at its centre, interpolated
/// linearly in the triangle there; outside the mesh those of the nearest point of its border, at
/// any distance.
/// side    [m] longer side of the pattern
/// loops   [texel] corners of the pattern's outline and holes; a coarse mesh may stay behind them
/// wanted  one entry for each texel of the rows
template <int first, int count, class DrawTexelRow>
void for_each_texel_row(const MapFields& fields, double side,
                        const std::vector<std::vector<Vector2d>>& loops, const MapRows& rows,
                        const std::vector<char>& wanted, const DrawTexelRow& texel_row) {
  const std::vector<Vector2d> vertices = vertices_in_texels(fields, side, rows.size);
  const auto corner = [&](int v) {
    return FieldCorner<count>{vertices[v], fields.of_vertex[v].template segment<count>(first)};
  };
  std::vector<char> open = wanted;
  TexelRow<count> row{};
  const auto draw_span = [&](const FieldSpan<count>& span) {
    for (int begin = span.begin; begin < span.end; begin += row.longest) {
      row.index = rows.index(begin, span.row);
      row.texels = std::min(span.end - begin, row.longest);
      row.wanted = open.data() + row.index;
      for (int k = 0; k < count; ++k) {
        const auto first_field =
            static_cast<float>(span.at_begin[k] + (begin - span.begin) * span.slope[k]);
        const auto slope = static_cast<float>(span.slope[k]);
        for (int i = 0, texels = row.padded(); i < texels; ++i)
          row.fields[k][i] = first_field + static_cast<float>(i) * slope;
      }
      texel_row(row);
      std::fill_n(open.begin() + row.index, row.texels, char(0));
    }
  };
  for (int t = 0; t < fields.triangles.rows(); ++t)
    for_each_span({corner(fields.triangles(t, 0)), corner(fields.triangles(t, 1)),
                   corner(fields.triangles(t, 2))},
                  rows, draw_span);
  constexpr char is_wanted = 1;
  row.texels = 1;
  row.wanted = &is_wanted;
  for (const BorderTexel& beside : texels_beside(fields, loops, vertices, rows, open)) {
    const auto [a, b] = fields.border[beside.edge];
    row.index = beside.index;
    for (int k = 0; k < count; ++k) {
      const double at_a = fields.of_vertex[a][first + k];
      row.fields[k][0] =
          static_cast<float>(at_a + beside.t * (fields.of_vertex[b][first + k] - at_a));
    }
    texel_row(row);
  }
}

/// The texels that a filtered lookup inside the pattern may read: those that overlap the pattern,
/// and those whose centre is at most map_padding texels from its border.
/// coverage  of area_coverage
inline constexpr int map_padding = 4;
std::vector<char> wanted_texels(const std::vector<std::vector<Vector2d>>& loops,
                                const std::vector<float>& coverage, const MapRows&);

}  // namespace paperbake
