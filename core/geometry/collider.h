#pragma once

#include "core/geometry/box_tree.h"
#include "core/model/sheet.h"

#include <Eigen/Geometry>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// |V|x3 [m] positions of the vertices of a mesh in every frame. Its copies share them until one of
/// them changes its own().
class SharedFrames {
 public:
  const std::vector<Points3>& all() const {
    static const std::vector<Points3> none;
    return all_ ? *all_ : none;
  }
  std::vector<Points3>& own() {
    if (!all_ || all_.use_count() > 1) all_ = std::make_shared<std::vector<Points3>>(all());
    return *all_;
  }
  bool empty() const { return all().empty(); }
  std::size_t size() const { return all().size(); }
  const Points3& operator[](std::size_t k) const { return all()[k]; }
  const Points3& at(std::size_t k) const { return all().at(k); }
  auto begin() const { return all().begin(); }
  auto end() const { return all().end(); }

 private:
  std::shared_ptr<std::vector<Points3>> all_;  // null: none
};

/// A triangle mesh that the paper must not penetrate, as read from the scene.
struct ColliderMesh {
  std::string name;
  // |V|x3 [m] vertex positions in the first frame; no two vertices coincide
  Points3 x;
  Triangles triangles;  // |T|x3 counter-clockwise seen from the front
  // element f: in frame first + f, between which vertices go straight; empty: the mesh stands still
  SharedFrames frames;
  double friction = 0.4;  // [1] Coulomb's coefficient of friction; paper on wood has 0.3-0.5
  // where the paper stays, of a closed mesh; `automatic` until face_the_sheet has decided
  enum class PaperSide { automatic, outside, inside } paper_side = PaperSide::automatic;
};

/// The point of a collider that is closest to a query point.
struct SurfacePoint {
  Vector3d at;      // [m] the point on the surface
  Vector3d normal;  // unit vector along which the distance grows
  double distance;  // [m] signed distance of the query point, negative behind the front
  int triangle = -1;
  bool on_border = false;  // of an open mesh
};

class MeshEdges;

/// An obstacle for the paper at one time, prepared for distance queries. For a closed mesh the
/// inside is forbidden, whatever the orientation of its triangles; for one that holds the paper, as
/// a cage does (PaperSide::inside), what is outside. For an open mesh the space
/// behind its front is forbidden, except to points that have come round its border.
class Collider {
 public:
  /// The collider in the first frame.
  explicit Collider(ColliderMesh);
  /// The same collider with its vertices elsewhere. x  |V|x3 [m]
  Collider(const Collider&, const Points3& x);

  /// The mesh; x is where its vertices are.
  const ColliderMesh& mesh() const { return mesh_; }
  const std::vector<Points3>& frames() const { return mesh_.frames.all(); }
  bool closed() const { return closed_; }

  Vector3d face_normal(int triangle) const { return face_normal_.row(triangle); }
  Vector3d vertex_normal(int vertex) const { return vertex_normal_.row(vertex); }  // mean by angle

  /// Greatest depth behind the front at which a point still counts as pressed in from there. [m]
  double depth() const { return depth_; }

  /// A convex edge or a border edge, and a corner on such edges. A feature of the sheet close to
  /// one of them is inside the collider when the shortest line from the feature to the edge (or
  /// corner) leads out of all its faces.
  struct Edge {
    int a, b;
    // unit vectors along its faces, perpendicular to the edge; at a border the second points
    // straight behind the first face
    std::array<Vector3d, 2> inward;
    // unit normals of the planes of its faces, each away from the other face
    std::array<Vector3d, 2> outward;
    bool border;
  };
  struct Corner {
    int vertex;
    bool border;
    // unit vectors along its edges; at a border the last points straight behind the surface
    std::vector<Vector3d> inward;
  };
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Corner>& corners() const { return corners_; }

  /// Boxes around the triangles, around edges() and around corners(). [m]
  const BoxTree& triangle_tree() const { return triangle_tree_; }
  const BoxTree& edge_tree() const { return edge_tree_; }
  const BoxTree& corner_tree() const { return corner_tree_; }

  /// The points of these triangles that are closest to p. The first is the closest of all, with
  /// signed distance. After it come those that have p in front of them in other directions (by 30
  /// degrees or more), as in the corner of a room. A side of -1 regards an open mesh from behind.
  /// source  [Baerentzen 2005] for the sign
  std::vector<SurfacePoint> nearest(const Vector3d& p, const std::vector<int>& triangles,
                                    int side) const;
  /// The closest point of the whole collider; its distance is infinite when none is closer than
  /// `within` [m].
  SurfacePoint nearest(const Vector3d& p, double within, int side) const;
  /// From which side a point of a sheet touches the collider: -1 if it is farther than depth()
  /// behind an open mesh, but not as far as `within` [m]: it has come round the border. Else 1.
  int side_of(const Vector3d& p, double within) const;
  /// The same for a point near one that is outside, from which it has come in a straight line: it
  /// has not come round the border if it has passed through the mesh.
  int side_of(const Vector3d& p, const Vector3d& known, double within) const;

 private:
  struct OnTriangle {
    Vector3d at, apart, pseudo_normal;  // closest point, vector from it to the query point
    bool border;
  };
  OnTriangle on_triangle(const Vector3d& p, int t) const;
  SurfacePoint surface_point(int t, const OnTriangle&, int side) const;
  /// From which side the way from p to q passes through the surface first: 1 from the front, -1
  /// from behind, 0 if it does not.
  int passes_through(const Vector3d& p, const Vector3d& q) const;

  struct FirstShape;  // what the shapes that the collider takes can share

  void prepare();
  // parts of the construction, in this order
  void find_normals();
  std::vector<char> find_sharp_edges(const MeshEdges&);  // returns |V| whether one ends there
  void find_corners(const MeshEdges&, const std::vector<char>& sharp);
  void build_trees();
  std::vector<std::array<int, 2>> ends_of_edges() const;
  std::vector<int> vertices_of_corners() const;

  ColliderMesh mesh_;
  bool closed_ = false;
  double depth_ = 0;
  Points3 face_normal_, vertex_normal_;  // |T|x3, |V|x3
  // [triangle][corner]: pseudo-normal of the edge opposite that corner, and whether it is a border
  std::vector<std::array<Vector3d, 3>> edge_normal_;
  std::vector<std::array<char, 3>> border_edge_;
  std::vector<char> border_vertex_;
  std::vector<Edge> edges_;
  std::vector<Corner> corners_;
  BoxTree triangle_tree_, edge_tree_, corner_tree_;
  std::shared_ptr<const FirstShape> first_;
};

using Colliders = std::vector<Collider>;
// the colliders as they are at one time. A collider that stands still is that of the Colliders,
// which must outlive this
using ColliderShapes = std::vector<std::shared_ptr<const Collider>>;

}  // namespace paperbake
