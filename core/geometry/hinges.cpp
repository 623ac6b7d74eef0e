#include "core/geometry/hinges.h"

#include "core/model/error.h"

#include <cmath>

namespace paperbake {

Hinges find_hinges(const Triangles& triangles) {
  struct Side {  // of a triangle, from a vertex to `to`; its other triangle is not found yet
    int to, triangle, corner, next;
  };
  constexpr int none = -1;
  Hinges result;
  result.of_triangle.assign(triangles.rows(), {-1, -1, -1});
  result.hinges.reserve(3 * triangles.rows() / 2);
  // for each vertex: head of the list in `open` of the sides that start there
  std::vector<int> first(triangles.size() ? triangles.maxCoeff() + 1 : 0, none);
  std::vector<Side> open;
  open.reserve(triangles.size());
  const auto link_to = [&](int from, int to) {
    int* link = &first[from];
    while (*link != none && open[*link].to != to) link = &open[*link].next;
    return link;
  };
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = triangles(t, (i + 1) % 3), b = triangles(t, (i + 2) % 3);
      int* const twin = link_to(b, a);
      if (*twin == none) {
        if (*link_to(a, b) != none)
          throw Error(
              ErrorCode::simulation, "mesh",
              "An edge of the mesh has more than two triangles, or two with opposite sides up.");
        open.push_back({b, t, i, first[a]});
        first[a] = static_cast<int>(open.size()) - 1;
        continue;
      }
      const Side other = open[*twin];
      *twin = other.next;
      result.of_triangle[other.triangle][other.corner] = result.of_triangle[t][i] =
          static_cast<int>(result.hinges.size());
      result.hinges.push_back(
          {{b, a, triangles(other.triangle, other.corner), triangles(t, i)}, {other.triangle, t}});
    }
  return result;
}

double dihedral_angle(const Points3& x, const Hinge& hinge) {
  const auto at = [&](int k) -> Vector3d { return x.row(hinge.vertices[k]); };
  const Vector3d x0 = at(0), e = at(1) - x0;
  const Vector3d left = e.cross(at(2) - x0), right = (at(3) - x0).cross(e);
  // both arguments have the factor |left||right|, so the normals need not be unit vectors
  return std::atan2(left.cross(right).dot(e) / e.norm(), left.dot(right));
}

std::vector<double> dihedral_angles(const Points3& x, const std::vector<Hinge>& hinges) {
  std::vector<double> theta(hinges.size());
  for (std::size_t h = 0; h < theta.size(); ++h) theta[h] = dihedral_angle(x, hinges[h]);
  return theta;
}

}  // namespace paperbake
