#pragma once

#include "core/model/handles.h"
#include "core/model/sheet.h"

#include <Eigen/Geometry>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// A mesh that the paper may not pass, as a scene has it.
struct ColliderMesh {
  std::string name;
  // |V|x3 [m] where it is in the first frame; no two vertices at one place
  Points3 x;
  Triangles triangles;  // front counter-clockwise
  // row f: from the first frame to frame first + f; empty: it stands still
  std::vector<Eigen::Isometry3d> motion;
  double friction = 0.4;  // [1] Coulomb's; paper on wood 0.3-0.5
};

/// A place on a collider, in the space of its first frame.
struct SurfacePoint {
  Vector3d at;      // [m]
  Vector3d normal;  // unit, along which the distance grows
  double distance;  // [m] signed: negative behind the front
};

/// A rigid mesh that the paper may not pass, ready to be asked. All places are in the space of its
/// first frame. Closed: its inside is forbidden, whichever way its triangles are turned. Open: its
/// back, as far as a point is not there because it came round the border.
class Collider {
 public:
  explicit Collider(ColliderMesh);

  const ColliderMesh& mesh() const { return mesh_; }
  bool closed() const { return closed_; }

  /// How far behind the front a point can be and still be thought of as pressed in from there. [m]
  double depth() const { return depth_; }

  /// An edge that sticks out, or of the border, and a corner of such. What is near one is inside
  /// when the way out of there, along the shortest line to it, goes away from all its faces.
  struct Edge {
    int a, b;
    // unit, along its faces; at a border the second is straight behind the first
    std::array<Vector3d, 2> inward;
    bool border;
  };
  struct Corner {
    int vertex;
    // unit, along its edges; at a border the last is straight behind it
    std::vector<Vector3d> inward;
  };
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Corner>& corners() const { return corners_; }

  /// Visits what may be nearer than `within` to the box low-high.
  void near_triangles(const Vector3d& low, const Vector3d& high, double within,
                      const std::function<void(int)>&) const;
  // of edges()
  void near_edges(const Vector3d& low, const Vector3d& high, double within,
                  const std::function<void(int)>&) const;
  // of corners()
  void near_corners(const Vector3d& low, const Vector3d& high, double within,
                    const std::function<void(int)>&) const;

  /// The points of these triangles nearest to p: the very nearest first, with the sign of its
  /// distance; behind it those in front of p in other directions (by 30 degrees and more), as in a
  /// corner of a room. side: -1 sees an open mesh from behind.
  /// source  [Baerentzen 2005] for the sign
  std::vector<SurfacePoint> nearest(const Vector3d& p, const std::vector<int>& triangles,
                                    int side) const;
  /// The nearest of all, infinitely far when none is within.
  SurfacePoint nearest(const Vector3d& p, double within, int side) const;

 private:
  /// Boxes in a binary tree: node k has the children 2k+1, 2k+2.
  class Tree {
   public:
    void build(std::vector<Eigen::AlignedBox3d> boxes);
    void visit(const Eigen::AlignedBox3d&, const std::function<void(int)>&) const;

   private:
    struct Node {
      Eigen::AlignedBox3d box;
      int left = -1, right = -1, item = -1;
    };
    int build(std::vector<int>& items, int begin, int end,
              const std::vector<Eigen::AlignedBox3d>& boxes);
    std::vector<Node> nodes_;
  };
  struct OnTriangle {
    Vector3d at, apart, pseudo_normal;  // apart: from there to the point
    bool border;
  };
  OnTriangle on_triangle(const Vector3d& p, int t) const;

  ColliderMesh mesh_;
  bool closed_ = false;
  double depth_ = 0;
  Points3 face_normal_, vertex_normal_;  // |T|x3, |V|x3
  // of each triangle, of the edge opposite its corner
  std::vector<std::array<Vector3d, 3>> edge_normal_;
  std::vector<std::array<char, 3>> border_edge_;
  std::vector<char> border_vertex_;
  std::vector<Edge> edges_;
  std::vector<Corner> corners_;
  Tree triangle_tree_, edge_tree_, corner_tree_;
};

using Colliders = std::vector<Collider>;
// of each collider: from its first frame to where it is
using Poses = std::vector<Eigen::Isometry3d>;

/// Where they are; before the first and after the last row they rest. row: frame - first frame
Poses poses_at(const Colliders&, int row);
/// Half way.
Poses between(const Poses&, const Poses&);
/// Farthest that any point of them goes. [m]
double farthest_move(const Colliders&, const Poses& from, const Poses& to);

/// Turns open meshes so that their front is on the side where most of the sheet is at the start;
/// where it lies in them, where handles go; where they do not tell, upwards.
/// keyed  [m] places where handles go
void face_the_sheet(std::vector<ColliderMesh>&, const Points3& x, const Points3& keyed);
/// Colliders of a scene so turned, for a sheet at x that these handles hold; null where there are
/// none.
std::shared_ptr<const Colliders> facing_colliders(std::vector<ColliderMesh>, const Points3& x,
                                                  const std::vector<Handle>&);

/// Moves points of a sheet that are inside of something out of it.
/// known   |V|x3 [m] near x, on the side of open meshes where the points belong; as x, or of a
///         surface that x smoothes
/// returns how deep the deepest was [m]
double push_out(const Colliders&, const Poses&, const Points3& known, double clearance, Points3& x);

}  // namespace paperbake
