#include "core/step2_crumple/vertex_insertion.h"

#include "core/geometry/hinges.h"
#include "core/geometry/point_location.h"
#include "core/geometry/prescribed_creases.h"
#include "core/geometry/proximity.h"
#include "core/geometry/singular_vertices.h"
#include "core/geometry/vertex_rings.h"
#include "core/model/segment2.h"

#include <algorithm>

namespace paperbake {
namespace {

template <class Matrix, class Row>
void append(Matrix& matrix, const Row& row) {
  matrix.conservativeResize(matrix.rows() + 1, Eigen::NoChange);
  matrix.row(matrix.rows() - 1) = row;
}

/// True when an edge from v to that point would be shorter than paper allows: it cuts across a
/// fold.
bool cuts_short(const Sheet& sheet, int v, const Vector2d& pattern_end, const Vector3d& end) {
  constexpr double max_compression = 0.005;
  return (sheet.x.row(v).transpose() - end).norm() <
         (1 - max_compression) * (sheet.pattern.row(v).transpose() - pattern_end).norm();
}

/// True when the one-ring of a vertex passes through nothing while the vertex moves to `end`,
/// tested by tetrahedra over the edges of the ring, and none of its edges cuts across a fold.
bool ring_has_room(const Sheet& sheet, int vertex, const Vector2d& pattern_end,
                   const Vector3d& end) {
  std::vector<int> ring;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    if ((sheet.triangles.row(t).array() == vertex).any()) ring.push_back(t);
  const auto at = [&](int v) -> Vector3d { return sheet.x.row(v); };
  return std::all_of(ring.begin(), ring.end(), [&](int t) {
    int i = 0;
    while (sheet.triangles(t, i) != vertex) ++i;
    const int a = sheet.triangles(t, (i + 1) % 3), b = sheet.triangles(t, (i + 2) % 3);
    if (cuts_short(sheet, a, pattern_end, end) || cuts_short(sheet, b, pattern_end, end))
      return false;
    return tetrahedron_is_empty(sheet, {a, b, vertex, -1}, {at(a), at(b), at(vertex), end}, ring,
                                0);
  });
}

/// True when p, seen from `beyond`, lies well between a and b on the pattern, so that the triangle
/// beyond the edge a-b can be extended to p.
bool sees_both(const Sheet& sheet, int beyond, int a, int b, const Vector2d& p) {
  constexpr double min_share = 0.1;
  const Vector2d o = sheet.pattern.row(beyond), u = sheet.pattern.row(a).transpose() - o,
                 w = sheet.pattern.row(b).transpose() - o, q = p - o;
  const double whole = cross(u, w);
  return cross(u, q) / whole > min_share && cross(q, w) / whole > min_share;
}

/// True if a vertex may move to p on the pattern without turning one of its triangles over.
bool triangles_stay(const Sheet& sheet, int vertex, const Vector2d& p) {
  const auto area = [&](int t, const Vector2d& at_vertex) {
    const auto corner = [&](int i) -> Vector2d {
      const int v = sheet.triangles(t, i);
      return v == vertex ? at_vertex : Vector2d(sheet.pattern.row(v));
    };
    const Vector2d u = corner(1) - corner(0), w = corner(2) - corner(0);
    return cross(u, w);
  };
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    if ((sheet.triangles.row(t).array() == vertex).any() &&
        !(area(t, p) > 0.3 * area(t, sheet.pattern.row(vertex))))
      return false;
  return true;
}

/// True if the triangle beyond a hinge of `triangle` may be extended to the vertex `added`, so that
/// the hinge is split there: nothing lies between.
bool may_split(const Sheet& sheet, const Hinge& hinge, int triangle, int added) {
  const Vector2d p = sheet.pattern.row(added);
  const int beyond = hinge.vertices[hinge.triangles[0] == triangle ? 3 : 2];
  const auto at = [&](int k) -> Vector3d { return sheet.x.row(k); };
  return sees_both(sheet, beyond, hinge.vertices[0], hinge.vertices[1], p) &&
         !cuts_short(sheet, beyond, p, at(added)) &&
         tetrahedron_is_empty(sheet, {hinge.vertices[0], hinge.vertices[1], beyond, added},
                              {at(hinge.vertices[0]), at(hinge.vertices[1]), at(beyond), at(added)},
                              {hinge.triangles[0], hinge.triangles[1]}, 0);
}

/// Divides a triangle at the vertex `added`: into three, or into two where the vertex lies on the
/// edge opposite the corner `left_out`.
void split_triangle(Sheet& sheet, int triangle, int left_out, int added) {
  const Eigen::RowVector3i c = sheet.triangles.row(triangle);
  bool first = true;
  for (int i = 0; i < 3; ++i) {
    if (i == left_out) continue;
    // the edge opposite corner i, and the new vertex
    const Eigen::RowVector3i part(c[(i + 1) % 3], c[(i + 2) % 3], added);
    if (first)
      sheet.triangles.row(triangle) = part;
    else
      append(sheet.triangles, part);
    first = false;
  }
}

/// Places an appended vertex where a mesh point is.
void place_vertex(Sheet& sheet, int vertex, const MeshPoint& place) {
  Points3 flat = Points3::Zero(sheet.pattern.rows(), 3);
  flat.leftCols<2>() = sheet.pattern;
  sheet.pattern.row(vertex) = interpolate(place, sheet.triangles, flat).head<2>().transpose();
  sheet.x.row(vertex) = interpolate(place, sheet.triangles, sheet.x).transpose();
  sheet.v.row(vertex) = interpolate(place, sheet.triangles, sheet.v).transpose();
}

}  // namespace

int insert_vertex(Sheet& sheet, const Vector2d& p, const std::vector<char>& fixed) {
  // barycentric weight below which p counts as lying on the opposite edge
  constexpr double near_edge = 0.15;
  MeshPoint place = PointLocator(sheet.pattern, sheet.triangles).locate(p);
  const int triangle = place.triangle;
  const Eigen::RowVector3d x = interpolate(place, sheet.triangles, sheet.x).transpose(),
                           v = interpolate(place, sheet.triangles, sheet.v).transpose();
  const Hinges hinges = find_hinges(sheet.triangles);
  const VertexRings rings(sheet.triangles, hinges, sheet.pattern.rows());
  const std::vector<char> singular = singular_vertices(sheet);
  const auto movable = [&](int k) {
    return !rings.border[k] && !singular[k] && !(k < static_cast<int>(fixed.size()) && fixed[k]);
  };

  int corner;
  place.weights.maxCoeff(&corner);
  if (const int nearest = sheet.triangles(triangle, corner);
      place.weights[corner] > 0.6 && movable(nearest) && triangles_stay(sheet, nearest, p) &&
      ring_has_room(sheet, nearest, p, x.transpose())) {
    sheet.pattern.row(nearest) = p.transpose();
    sheet.x.row(nearest) = x;
    sheet.v.row(nearest) = v;
    return nearest;
  }

  const int added = static_cast<int>(sheet.pattern.rows());
  append(sheet.pattern, p.transpose());
  append(sheet.x, x);
  append(sheet.v, v);
  int edge;
  const bool near = place.weights.minCoeff(&edge) < near_edge;
  const int h = hinges.of_triangle[triangle][edge];
  if (!near || h < 0 ||
      is_on_crease(sheet.prescribed_creases, sheet.pattern,
                   sheet.triangles(triangle, (edge + 1) % 3),
                   sheet.triangles(triangle, (edge + 2) % 3))) {
    split_triangle(sheet, triangle, -1, added);
  } else if (may_split(sheet, hinges.hinges[h], triangle, added)) {
    const auto& sides = hinges.hinges[h].triangles;
    const int other = sides[0] == triangle ? sides[1] : sides[0];
    const auto& edges = hinges.of_triangle[other];
    split_triangle(sheet, triangle, edge, added);
    split_triangle(sheet, other,
                   static_cast<int>(std::find(edges.begin(), edges.end(), h) - edges.begin()),
                   added);
  } else {  // farther inside, so that the triangle at the edge does not become too thin
    place.weights *= (1 - near_edge) / (1 - place.weights[edge]);
    place.weights[edge] = near_edge;
    place_vertex(sheet, added, place);
    split_triangle(sheet, triangle, -1, added);
  }
  return added;
}

}  // namespace paperbake
