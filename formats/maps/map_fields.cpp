#include "formats/maps/map_fields.h"

#include "core/geometry/hinges.h"
#include "core/model/segment2.h"

#include <limits>

namespace paperbake {
namespace {

/// Green strain of a triangle in the coordinates of the pattern: (FᵀF - I)/2 as xx, xy, yy [1], and
/// its area on the pattern [m2].
Eigen::RowVector3d green_strain(const Sheet& sheet, int t, double& area) {
  const int a = sheet.triangles(t, 0), b = sheet.triangles(t, 1), c = sheet.triangles(t, 2);
  Eigen::Matrix2d rest;
  rest << (sheet.pattern.row(b) - sheet.pattern.row(a)).transpose(),
      (sheet.pattern.row(c) - sheet.pattern.row(a)).transpose();
  Eigen::Matrix<double, 3, 2> now;
  now << (sheet.x.row(b) - sheet.x.row(a)).transpose(),
      (sheet.x.row(c) - sheet.x.row(a)).transpose();
  area = 0.5 * rest.determinant();
  if (area <= 0) return Eigen::RowVector3d::Zero();
  const Eigen::Matrix<double, 3, 2> F = now * rest.inverse();
  const Eigen::Matrix2d G = 0.5 * (F.transpose() * F - Eigen::Matrix2d::Identity());
  return {G(0, 0), G(0, 1), G(1, 1)};
}

/// [texel] the largest distance from a corner of the pattern to the border of the mesh: a coarse
/// mesh cuts the corners of a round outline.
double max_border_gap(const std::vector<std::vector<Vector2d>>& loops,
                      const std::vector<Vector2d>& vertices, const MapFields& fields) {
  double gap = 0;
  for (const auto& loop : loops)
    for (const Vector2d& p : loop) {
      double nearest = std::numeric_limits<double>::max();
      for (const auto& [a, b] : fields.border)
        nearest = std::min(nearest, distance_to_segment(p, vertices[a], vertices[b]));
      if (!fields.border.empty()) gap = std::max(gap, nearest);
    }
  return gap;
}

}  // namespace

MapFields map_fields(const Sheet& sheet, const Points3& curvature, const Points3& plastic,
                     double fold_width) {
  const Hinges hinges = find_hinges(sheet.triangles);
  MapFields fields{sheet.pattern,
                   sheet.triangles,
                   std::vector<Fields>(sheet.pattern.rows(), Fields::Zero()),
                   sharp_folds(sheet, hinges, curvature, plastic),
                   {}};
  const Eigen::VectorXd width = fold_widths(sheet, hinges, fold_width);
  const Points3 fold = fold_tensors(curvature, width),
                plastic_fold = plastic.rows() > 0 ? fold_tensors(plastic, width) : Points3();
  std::vector<double> area_around(sheet.pattern.rows(), 0.0);
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    double area;
    const Eigen::RowVector3d strain = green_strain(sheet, t, area);
    for (int k = 0; k < 3; ++k) {
      fields.of_vertex[sheet.triangles(t, k)].segment<3>(of_strain) +=
          area * strain.transpose().array();
      area_around[sheet.triangles(t, k)] += area;
    }
  }
  for (std::size_t v = 0; v < area_around.size(); ++v) {
    Fields& f = fields.of_vertex[v];
    if (area_around[v] > 0) f.segment<3>(of_strain) /= area_around[v];
    f.segment<3>(of_curvature) = curvature.row(v).transpose().array();
    f.segment<3>(of_fold) = fold.row(v).transpose().array();
    if (plastic.rows() > 0) f.segment<3>(of_plastic_fold) = plastic_fold.row(v).transpose().array();
  }
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      if (hinges.of_triangle[t][k] < 0)
        fields.border.push_back({sheet.triangles(t, (k + 1) % 3), sheet.triangles(t, (k + 2) % 3)});
  return fields;
}

std::vector<Vector2d> vertices_in_texels(const MapFields& fields, double side, int size) {
  std::vector<Vector2d> vertices;
  for (int v = 0; v < fields.pattern.rows(); ++v)
    vertices.push_back(to_texels(fields.pattern.row(v), side, size));
  return vertices;
}

std::vector<BorderTexel> texels_beside(const MapFields& fields,
                                       const std::vector<std::vector<Vector2d>>& loops,
                                       const std::vector<Vector2d>& vertices, const MapRows& rows,
                                       const std::vector<char>& open) {
  std::vector<BorderTexel> found;
  if (std::find(open.begin(), open.end(), 1) == open.end()) return found;
  struct Nearest {
    float distance = std::numeric_limits<float>::max();
    int edge = -1;
    float t = 0;
  };
  constexpr int band_rows = 16;  // whose nearest points stay in the cache
  std::vector<Nearest> nearest;
  const double reach = max_border_gap(loops, vertices, fields) + map_padding + 2;
  for (int top = rows.first; top < rows.last; top += band_rows) {
    const MapRows band{rows.size, top, std::min(top + band_rows, rows.last)};
    const char* open_here = open.data() + rows.index(0, top);
    if (std::find(open_here, open_here + band.count(), 1) == open_here + band.count()) continue;
    nearest.assign(band.count(), {});
    for (std::size_t e = 0; e < fields.border.size(); ++e)
      for_each_near_segment(vertices[fields.border[e].first], vertices[fields.border[e].second],
                            reach, band, [&](int i, int row, double distance, double t) {
                              Nearest& n = nearest[band.index(i, row)];
                              if (open_here[band.index(i, row)] && distance < n.distance)
                                n = {float(distance), int(e), float(t)};
                            });
    for (int k = 0; k < band.count(); ++k)
      if (open_here[k] && nearest[k].edge >= 0)
        found.push_back({rows.index(0, top) + k, nearest[k].edge, double(nearest[k].t)});
  }
  return found;
}

std::vector<char> wanted_texels(const std::vector<std::vector<Vector2d>>& loops,
                                const std::vector<float>& coverage, const MapRows& rows) {
  std::vector<char> wanted(coverage.size());
  std::transform(coverage.begin(), coverage.end(), wanted.begin(),
                 [](float a) { return char(a > 0); });
  for (const auto& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k)
      for_each_near_segment(
          loop[k], loop[(k + 1) % loop.size()], map_padding, rows,
          [&](int i, int row, double, double) { wanted[rows.index(i, row)] = 1; });
  return wanted;
}

}  // namespace paperbake
