#pragma once

#include "core/geometry/collider.h"

#include <cmath>
#include <memory>
#include <vector>

namespace paperbake::test {

/// A square in the plane z = 0 around the origin, whose front is up. half  [m] half its side
inline ColliderMesh ground(double half = 0.5, double friction = 0.4) {
  ColliderMesh mesh{"ground", Points3(4, 3), Triangles(2, 3), {}, friction};
  mesh.x << -half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0;
  mesh.triangles << 0, 1, 2, 0, 2, 3;
  return mesh;
}

/// A box whose triangles face outwards or, when `inside_out`, inwards.
inline ColliderMesh box(const Vector3d& low, const Vector3d& high, bool inside_out = false) {
  ColliderMesh mesh{"box", Points3(8, 3), Triangles(12, 3), {}};
  for (int v = 0; v < 8; ++v)
    mesh.x.row(v) << (v & 1 ? high : low).x(), (v & 2 ? high : low).y(), (v & 4 ? high : low).z();
  mesh.triangles << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6,
      0, 6, 2, 1, 3, 7, 1, 7, 5;
  if (inside_out) mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

/// A bin without a lid: four walls from z = -0.1 to 0 round a square of this half width.
inline ColliderMesh bin(double half) {
  ColliderMesh mesh{"bin", Points3(8, 3), Triangles(10, 3), {}};
  for (int k = 0; k < 4; ++k) {
    const double x = k == 0 || k == 3 ? -half : half, y = k < 2 ? -half : half;
    mesh.x.row(k) << x, y, -0.1;
    mesh.x.row(4 + k) << x, y, 0;
    const int next = (k + 1) % 4;
    mesh.triangles.row(2 * k) << k, next, 4 + next;
    mesh.triangles.row(2 * k + 1) << k, 4 + next, 4 + k;
  }
  mesh.triangles.row(8) << 0, 2, 1;
  mesh.triangles.row(9) << 0, 3, 2;
  return mesh;
}

/// A ball round the origin of `around` x `along` corners and its two poles.
inline ColliderMesh ball(double radius, int around, int along) {
  const int last = around * along + 1;
  ColliderMesh mesh{"ball", Points3(last + 1, 3), Triangles(2 * around * along, 3), {}};
  mesh.x.row(0) << 0, 0, -radius;
  mesh.x.row(last) << 0, 0, radius;
  int t = 0;
  for (int k = 0; k < along; ++k)
    for (int i = 0; i < around; ++i) {
      const double theta = M_PI * (k + 1) / (along + 1), phi = 2 * M_PI * i / around;
      const int here = 1 + k * around + i, beside = 1 + k * around + (i + 1) % around;
      mesh.x.row(here) =
          radius * Eigen::RowVector3d(std::sin(theta) * std::cos(phi),
                                      std::sin(theta) * std::sin(phi), -std::cos(theta));
      if (k == 0) mesh.triangles.row(t++) << 0, beside, here;
      if (k + 1 == along) {
        mesh.triangles.row(t++) << last, here, beside;
      } else {
        mesh.triangles.row(t++) << here, beside, beside + around;
        mesh.triangles.row(t++) << here, beside + around, here + around;
      }
    }
  return mesh;
}

inline std::shared_ptr<const Colliders> all(const std::vector<ColliderMesh>& meshes) {
  return std::make_shared<const Colliders>(meshes.begin(), meshes.end());
}

}  // namespace paperbake::test
