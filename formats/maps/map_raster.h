#pragma once

#include "core/model/segment2.h"
#include "core/model/sheet.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace paperbake {

/// A point of the pattern in texels of a square map over the render uv: (i, j) is the centre of
/// texel i of row j, with row 0 at the top.
/// pattern  [m]
/// side     [m] longer side of the pattern
/// size     texels on a side of the map
Vector2d to_texels(const Vector2d& pattern, double side, int size);

/// The rows first <= row < last of a map of size x size texels. Maps are drawn in such strips,
/// independently of each other.
struct MapRows {
  int size, first, last;

  int count() const { return (last - first) * size; }
  int index(int i, int row) const { return (row - first) * size + i; }
};

/// The exact part of each texel that lies in the polygons. [0, 1]
/// loops  corners [texel]; on the pattern outlines are counter-clockwise and holes clockwise
std::vector<float> area_coverage(const std::vector<std::vector<Vector2d>>& loops, const MapRows&);

/// A corner of a triangle, and quantities that are interpolated linearly in it.
template <int count>
struct FieldCorner {
  Vector2d at;  // [texel]
  Eigen::Array<double, count, 1> fields;
};

/// Texels of a row whose centres lie in a triangle: begin <= i < end.
template <int count>
struct FieldSpan {
  int row, begin, end;
  // of the fields at texel i: at_begin + (i - begin) slope
  Eigen::Array<double, count, 1> at_begin, slope;
};

namespace raster {

inline int first_at_or_after(double x, int low, int high) {
  return static_cast<int>(std::ceil(std::clamp(x, double(low), double(high))));
}

/// Where an edge meets a row. It is always computed from the upper end of the edge, so that the two
/// triangles of an edge get exactly the same point.
inline double cut_edge(const Vector2d& p, const Vector2d& q, int row) {
  const bool p_first = p.y() < q.y();
  const Vector2d &a = p_first ? p : q, &b = p_first ? q : p;
  return a.x() + (row - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

/// By how much fields change from texel to texel of a triangle.
template <int count>
struct FieldSlopes {
  Eigen::Array<double, count, 1> along_row, down;
};

template <int count>
FieldSlopes<count> slopes(const FieldCorner<count> (&corner)[3]) {
  constexpr double none = 1e-9;  // [texel2] a triangle of no area has the fields of one corner
  const Vector2d u = corner[1].at - corner[0].at, v = corner[2].at - corner[0].at;
  const double doubled = cross(u, v), scale = std::abs(doubled) > none ? 1 / doubled : 0;
  const Eigen::Array<double, count, 1> along_u = scale * (corner[1].fields - corner[0].fields),
                                       along_v = scale * (corner[2].fields - corner[0].fields);
  return {v.y() * along_u - u.y() * along_v, u.x() * along_v - v.x() * along_u};
}

}  // namespace raster

/// Calls span(FieldSpan) for every row of texels whose centres lie in the triangle. Spans are half
/// open in both directions, so that triangles with a common edge leave no gap and share no texel.
template <int count, class Span>
void for_each_span(const FieldCorner<count> (&corner)[3], const MapRows& rows, const Span& span) {
  const auto [top, bottom] = std::minmax({corner[0].at.y(), corner[1].at.y(), corner[2].at.y()});
  const int first_row = raster::first_at_or_after(top, rows.first, rows.last),
            end_row = raster::first_at_or_after(bottom, rows.first, rows.last);
  if (first_row >= end_row) return;
  const raster::FieldSlopes<count> slopes = raster::slopes(corner);
  for (int row = first_row; row < end_row; ++row) {
    double cut[2];
    int cuts = 0;
    for (int k = 0; k < 3; ++k) {
      const Vector2d &p = corner[k].at, &q = corner[(k + 1) % 3].at;
      if ((p.y() <= row) != (q.y() <= row) && cuts < 2) cut[cuts++] = raster::cut_edge(p, q, row);
    }
    if (cuts < 2) continue;
    const auto [left, right] = std::minmax(cut[0], cut[1]);
    const int begin = raster::first_at_or_after(left, 0, rows.size),
              end = raster::first_at_or_after(right, 0, rows.size);
    if (begin >= end) continue;
    span(FieldSpan<count>{row, begin, end,
                          corner[0].fields + (begin - corner[0].at.x()) * slopes.along_row +
                              (row - corner[0].at.y()) * slopes.down,
                          slopes.along_row});
  }
}

/// Calls texel(i, row, distance, t) for every texel whose centre is within `reach` of the segment;
/// its nearest point on the segment is a + t (b - a), t in [0, 1]. Lengths are in texels.
template <class Texel>
void for_each_near_segment(const Vector2d& a, const Vector2d& b, double reach, const MapRows& rows,
                           const Texel& texel) {
  const Vector2d along = b - a;
  const double squared = std::max(along.squaredNorm(), 1e-300);
  const auto [top, bottom] = std::minmax({a.y(), b.y()});
  const int end_row =
      raster::first_at_or_after(std::floor(bottom + reach) + 1, rows.first, rows.last);
  for (int row = raster::first_at_or_after(top - reach, rows.first, rows.last); row < end_row;
       ++row) {
    // the part of the segment that can be within reach of this row
    double from = 0, to = 1;
    if (std::abs(along.y()) > 1e-9) {
      const double s = (row - reach - a.y()) / along.y(), e = (row + reach - a.y()) / along.y();
      from = std::clamp(std::min(s, e), 0.0, 1.0);
      to = std::clamp(std::max(s, e), 0.0, 1.0);
    }
    const auto [left, right] = std::minmax({a.x() + from * along.x(), a.x() + to * along.x()});
    const int end = raster::first_at_or_after(std::floor(right + reach) + 1, 0, rows.size);
    for (int i = raster::first_at_or_after(left - reach, 0, rows.size); i < end; ++i) {
      const Vector2d p(i, row);
      const double t = std::clamp((p - a).dot(along) / squared, 0.0, 1.0),
                   distance = (p - a - t * along).norm();
      if (distance <= reach) texel(i, row, distance, t);
    }
  }
}

/// Indices of the points that may be the nearest one to some texel of a block with this centre and
/// half diagonal `reach`. All in texels.
std::vector<int> near_points(const std::vector<Vector2d>& points, const Vector2d& centre,
                             double reach);

}  // namespace paperbake
