#include "core/render/subdivision.h"

#include "core/geometry/hinges.h"

#include <algorithm>

namespace paperbake {

Subdivision subdivide(const RenderMesh& mesh, const Triangles& of_corner) {
  const Hinges hinges = find_hinges(mesh.triangles);
  const int vertices = static_cast<int>(mesh.pattern.rows()),
            triangles = static_cast<int>(mesh.triangles.rows());
  Subdivision result;
  Triangles middle(triangles, 3);  // vertex on the edge opposite each corner
  std::vector<int> of_hinge(hinges.hinges.size(), -1);
  for (int t = 0; t < triangles; ++t)
    for (int i = 0; i < 3; ++i) {
      const int h = hinges.of_triangle[t][i], j = (i + 1) % 3, k = (i + 2) % 3;
      // seen from the other side, where a and b are the other way round
      if (h >= 0 && of_hinge[h] >= 0) {
        Subdivision::Middle& m = result.middles[of_hinge[h]];
        m.normal_a[1] = of_corner(t, k);
        m.normal_b[1] = of_corner(t, j);
        middle(t, i) = vertices + of_hinge[h];
        continue;
      }
      if (h >= 0) of_hinge[h] = static_cast<int>(result.middles.size());
      middle(t, i) = vertices + static_cast<int>(result.middles.size());
      result.middles.push_back({mesh.triangles(t, j),
                                mesh.triangles(t, k),
                                {of_corner(t, j), of_corner(t, j)},
                                {of_corner(t, k), of_corner(t, k)}});
    }

  RenderMesh& fine = result.mesh;
  fine.pattern.resize(vertices + result.middles.size(), 2);
  fine.pattern.topRows(vertices) = mesh.pattern;
  for (std::size_t m = 0; m < result.middles.size(); ++m) {
    const auto [a, b] = std::minmax(result.middles[m].a, result.middles[m].b);
    const int v = vertices + static_cast<int>(m);
    fine.pattern.row(v) = 0.5 * (mesh.pattern.row(a) + mesh.pattern.row(b));
    if (!std::binary_search(mesh.creases.begin(), mesh.creases.end(), std::pair<int, int>(a, b)))
      continue;
    fine.creases.emplace_back(a, v);
    fine.creases.emplace_back(b, v);
  }
  std::sort(fine.creases.begin(), fine.creases.end());
  fine.point_vertex = mesh.point_vertex;
  fine.prescribed_creases = mesh.prescribed_creases;
  fine.triangles.resize(4 * triangles, 3);
  for (int t = 0; t < triangles; ++t) {
    const auto v = mesh.triangles.row(t);
    const auto m = middle.row(t);
    fine.triangles.row(4 * t) << v[0], m[2], m[1];
    fine.triangles.row(4 * t + 1) << v[1], m[0], m[2];
    fine.triangles.row(4 * t + 2) << v[2], m[1], m[0];
    fine.triangles.row(4 * t + 3) << m[0], m[1], m[2];
  }
  return result;
}

Points3 Subdivision::positions(const Points3& x, const Points3& normals) const {
  Points3 fine(mesh.pattern.rows(), 3);
  fine.topRows(x.rows()) = x;
  for (std::size_t k = 0; k < middles.size(); ++k) {
    const Middle& m = middles[k];
    const Eigen::RowVector3d edge = x.row(m.b) - x.row(m.a);
    Eigen::RowVector3d drop(0, 0, 0);
    for (int side = 0; side < 2; ++side) {
      const Eigen::RowVector3d a = normals.row(m.normal_a[side]), b = normals.row(m.normal_b[side]);
      drop += edge.dot(a) * a - edge.dot(b) * b;
    }
    fine.row(x.rows() + k) = 0.5 * (x.row(m.a) + x.row(m.b)) - drop / 16;
  }
  return fine;
}

}  // namespace paperbake
