#include "core/step2_crumple/vertex_moves.h"

#include "core/geometry/point_location.h"
#include "core/geometry/proximity.h"
#include "core/model/segment2.h"

#include <algorithm>

namespace paperbake {
namespace {

constexpr double max_compression = 0.02;  // [1] of the length of an edge
constexpr double thin = 0.25;             // [1] height of a triangle over its longest edge

/// The two other corners of a triangle, counter-clockwise after the vertex.
std::array<int, 2> opposite(const Sheet& sheet, int triangle, int vertex) {
  int i = 0;
  while (sheet.triangles(triangle, i) != vertex) ++i;
  return {sheet.triangles(triangle, (i + 1) % 3), sheet.triangles(triangle, (i + 2) % 3)};
}

/// Height over the longest edge, the smallest of the ring with the vertex at p; negative if one of
/// its triangles is turned over.
double worst_shape(const Sheet& sheet, const std::vector<int>& ring, int vertex,
                   const Vector2d& p) {
  double worst = 1;
  for (const int t : ring) {
    const auto [a, b] = opposite(sheet, t, vertex);
    const Vector2d u = sheet.pattern.row(a).transpose() - p,
                   v = sheet.pattern.row(b).transpose() - p;
    const double longest2 = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
    worst = std::min(worst, cross(u, v) / longest2);
  }
  return worst;
}

/// The place of p on the triangles of the ring, with weights of their corners.
std::optional<MeshPoint> locate(const Sheet& sheet, const std::vector<int>& ring,
                                const Vector2d& p) {
  constexpr double rounding = 1e-9;
  for (const int t : ring) {
    const Vector2d q[3] = {sheet.pattern.row(sheet.triangles(t, 0)),
                           sheet.pattern.row(sheet.triangles(t, 1)),
                           sheet.pattern.row(sheet.triangles(t, 2))};
    const double whole = cross(q[1] - q[0], q[2] - q[0]);
    const Vector3d weights(cross(q[1] - p, q[2] - p) / whole, cross(q[2] - p, q[0] - p) / whole,
                           cross(q[0] - p, q[1] - p) / whole);
    if (weights.minCoeff() > -rounding) return MeshPoint{t, weights};
  }
  return std::nullopt;
}

/// True if the sheet may follow when the vertex goes to this place in space.
bool has_room(const Sheet& sheet, const std::vector<int>& ring, int vertex, const Vector2d& p,
              const Vector3d& end) {
  const auto at = [&](int v) -> Vector3d { return sheet.x.row(v); };
  const auto keeps_length = [&](int v) {
    return (at(v) - end).norm() >=
           (1 - max_compression) * (sheet.pattern.row(v).transpose() - p).norm();
  };
  return std::all_of(ring.begin(), ring.end(), [&](int t) {
    const auto [a, b] = opposite(sheet, t, vertex);
    return keeps_length(a) && keeps_length(b) &&
           tetrahedron_is_empty(sheet, {a, b, vertex, -1}, {at(a), at(b), at(vertex), end}, ring,
                                0);
  });
}

}  // namespace

double move_vertex(Sheet& sheet, const VertexRings& rings, int vertex, const Vector2d& p) {
  const std::vector<int>& ring = rings.triangles[vertex];
  const Vector2d from = sheet.pattern.row(vertex);
  const double least = std::min(thin, worst_shape(sheet, ring, vertex, from));
  for (const double part : {1.0, 0.5, 0.25}) {
    const Vector2d to = from + part * (p - from);
    if (worst_shape(sheet, ring, vertex, to) < least) continue;
    const std::optional<MeshPoint> place = locate(sheet, ring, to);
    if (!place) continue;
    const Vector3d x = interpolate(*place, sheet.triangles, sheet.x);
    if (!has_room(sheet, ring, vertex, to, x)) continue;
    const Vector3d v = interpolate(*place, sheet.triangles, sheet.v);
    sheet.pattern.row(vertex) = to.transpose();
    sheet.x.row(vertex) = x.transpose();
    sheet.v.row(vertex) = v.transpose();
    return part;
  }
  return 0;
}

}  // namespace paperbake
