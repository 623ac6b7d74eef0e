#include "core/geometry/collider_facing.h"

#include "core/geometry/mesh_edges.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace paperbake {
namespace {

/// Where the paper stays if it is to stay where it begins.
ColliderMesh::PaperSide side_of(const Collider& solid, const Points3& x) {
  constexpr double anywhere = 1e6;  // [m]
  for (int v = 0; v < x.rows(); ++v)
    if (!(solid.nearest(x.row(v), anywhere, 1).distance < 0))
      return ColliderMesh::PaperSide::outside;
  return ColliderMesh::PaperSide::inside;
}

/// [m2] The area of the mesh as seen from above, less what faces downwards.
double upward_area(const ColliderMesh& mesh) {
  double doubled = 0;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const Vector3d a = mesh.x.row(mesh.triangles(t, 0)), b = mesh.x.row(mesh.triangles(t, 1)),
                   c = mesh.x.row(mesh.triangles(t, 2));
    doubled += (b - a).cross(c - a).z();
  }
  return 0.5 * doubled;
}

/// On which side of an open mesh points are.
struct Votes {
  int over = 0;  // of those above or below it, how many more are in front of it than behind
  // of those beside it, how many are in front and behind of where it would be if it went on there
  int in_front = 0, behind = 0;

  /// 1 or -1: all those beside it are in front or behind; 0: they are on both sides, or there are
  /// none.
  int beside() const { return (behind == 0) - (in_front == 0); }
};

Votes votes(const Collider& open, const Points3& points) {
  constexpr double anywhere = 10, lies_in_it = 1e-5;  // [m] a point closer than this has no vote
  Votes votes;
  for (int v = 0; v < points.rows(); ++v) {
    const SurfacePoint near = open.nearest(points.row(v), anywhere, 1);
    if (near.triangle < 0 || !(std::abs(near.distance) > lies_in_it)) continue;
    if (!near.on_border) {
      votes.over += near.distance > 0 ? 1 : -1;
      continue;
    }
    // beyond the border, as beside the mouth of a bin, there is neither front nor back
    const double ahead = open.face_normal(near.triangle).dot(points.row(v).transpose() - near.at);
    if (std::abs(ahead) > lies_in_it) (ahead > 0 ? votes.in_front : votes.behind) += 1;
  }
  return votes;
}

}  // namespace

int turn_to_neighbours(Triangles& triangles) {
  const MeshEdges edges(triangles);
  struct Neighbour {
    int triangle;
    bool alike;  // faces the same way
  };
  const int n = static_cast<int>(triangles.rows());
  std::vector<std::vector<Neighbour>> neighbours(n);
  for (const MeshEdge& edge : edges)
    if (edge.size() == 2) {
      const bool alike = edge[0].forwards != edge[1].forwards;
      neighbours[edge[0].triangle].push_back({edge[1].triangle, alike});
      neighbours[edge[1].triangle].push_back({edge[0].triangle, alike});
    }
  enum : char { unknown, kept, turned };
  std::vector<char> facing(n, unknown);
  int count = 0;
  for (int start = 0; start < n; ++start) {
    if (facing[start] != unknown) continue;
    facing[start] = kept;
    std::vector<int> part{start};
    for (std::size_t k = 0; k < part.size(); ++k)
      for (const Neighbour& next : neighbours[part[k]])
        if (facing[next.triangle] == unknown) {
          facing[next.triangle] = (facing[part[k]] == kept) == next.alike ? kept : turned;
          part.push_back(next.triangle);
        }
    const auto others =
        std::count_if(part.begin(), part.end(), [&](int t) { return facing[t] == turned; });
    const bool most_turned = 2 * others > static_cast<long>(part.size());
    for (const int t : part)
      if ((facing[t] == turned) != most_turned) {
        std::swap(triangles(t, 1), triangles(t, 2));
        ++count;
      }
  }
  return count;
}

void face_the_sheet(std::vector<ColliderMesh>& meshes, const Points3& x, const Points3& keyed) {
  for (ColliderMesh& mesh : meshes) {
    const Collider as_it_is(mesh);
    if (as_it_is.closed()) {
      using Side = ColliderMesh::PaperSide;
      if (mesh.paper_side == Side::automatic) mesh.paper_side = side_of(as_it_is, x);
      continue;
    }
    const Votes of_sheet = votes(as_it_is, x);
    int front = of_sheet.over;
    if (front == 0) front = votes(as_it_is, keyed).over;
    if (front == 0) front = of_sheet.beside();
    if (front < 0 || (front == 0 && upward_area(mesh) < 0))
      mesh.triangles.col(1).swap(mesh.triangles.col(2));
  }
}

std::shared_ptr<const Colliders> facing_colliders(std::vector<ColliderMesh> meshes,
                                                  const Points3& x,
                                                  const std::vector<Handle>& handles) {
  if (meshes.empty()) return nullptr;
  long rows = 0;
  for (const Handle& handle : handles) rows += handle.keyed.rows();
  Points3 keyed(rows, 3);
  for (const Handle& handle : handles)
    keyed.middleRows(rows -= handle.keyed.rows(), handle.keyed.rows()) = handle.keyed;
  face_the_sheet(meshes, x, keyed);
  return std::make_shared<const Colliders>(meshes.begin(), meshes.end());
}

}  // namespace paperbake
