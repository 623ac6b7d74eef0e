#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

namespace paperbake {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Points2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
using Points3 = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Whether two matrices have the same size and the same entries. (Eigen's == wants the same size.)
template <typename Matrix>
bool same_entries(const Matrix& a, const Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

/// A frame of the animation and its duration.
struct FrameTime {
  int frame = 1;
  double dt = 1 / 24.0;  // [s] since the frame before
  // [1] farthest motion of a handle or a point of the sheet in this frame, over the longer side
  double moved = 0;
  double seconds() const { return frame * dt; }  // [s] since frame 0
};

/// The apex of a d-cone: a point at which the paper is broken. It stays for ever, at its place on
/// the pattern [Schreck 2015, step 2].
struct SingularPoint {
  Vector2d pattern;  // [m]
  int frame_of_birth;
  std::string cause;
};

/// A prescribed crease: a line along which the paper was folded before the first frame, or along
/// which the handles are going to fold it. It consists of edges in every mesh. Where it is folded,
/// these are hinges (crease_law.h); where it is not folded yet, the paper bends as everywhere else.
struct PrescribedCrease {
  std::vector<Vector2d> line;  // [m] polyline on the pattern, at least two points
  double angle = 0;            // [rad] it springs back to this; > 0 bulges towards the normals
  bool folded = true;          // before the first frame
};

/// The state of a prescribed crease at one of the mesh edges it consists of.
struct CreaseEdge {
  Vector2d a, b;          // [m] ends of the edge on the pattern
  double rest_angle = 0;  // [rad] theta_p: it springs back to this
  bool folded = true;     // false: the paper has never been folded here
  // [rad] the angle of the hands that press it in this frame; none: it is free
  std::optional<double> pressed = {};
};

/// An edge along which the paper has been a crease: it does not heal, but stays one when it opens.
struct RememberedCrease {
  int a, b;      // vertices of the sheet
  double share;  // [1] how far it was one at its sharpest (crease_share)
};

/// A sheet of paper at one moment: its flat pattern and where it is in space.
struct Sheet {
  Points2 pattern;      // |V|x2 [m]    flat rest shape
  Points3 x;            // |V|x3 [m]    present positions of the vertices
  Points3 v;            // |V|x3 [m/s]
  Triangles triangles;  // |T|x3        counter-clockwise in the pattern
  // apices in order of birth; paper does not heal, so the list only grows
  std::vector<SingularPoint> singular;
  std::vector<PrescribedCrease> prescribed_creases = {};  // the same in all frames
  // their state where it is no longer that of the first frame. It may come from an earlier mesh:
  // prescribed_creases.h finds the state of an edge
  std::vector<CreaseEdge> crease_edges = {};
  // edges that have been creases, and are less so now; known only where it is rendered (ShotRecord)
  std::vector<RememberedCrease> remembered = {};
};

/// A sheet with so many singular points is crumpled: one with fewer is smooth elsewhere.
constexpr int points_of_a_crumple = 3;
inline bool is_crumpled(const Sheet& sheet) {
  return static_cast<int>(sheet.singular.size()) >= points_of_a_crumple;
}

}  // namespace paperbake
