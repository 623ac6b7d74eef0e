#pragma once

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace paperbake {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Points2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
using Points3 = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A frame of the animation and how long it is.
struct FrameTime {
  int frame = 1;
  double dt = 1 / 24.0;  // [s] from the frame before
  // [1] of the longer side: farthest that a handle or a point of the sheet goes in it
  double moved = 0;
  double seconds() const { return frame * dt; }  // [s] since frame 0
};

/// The apex of a d-cone: paper broken at a point. It stays for ever, at its place on the pattern
/// [Schreck 2015, step 2].
struct SingularPoint {
  Vector2d pattern;  // [m]
  int frame_of_birth;
  std::string cause;
};

/// A line along which the paper was folded before the first frame: edges of every mesh, which turn
/// easily.
struct PrescribedCrease {
  std::vector<Vector2d> line;  // [m] polyline on the pattern, at least two points
  double angle = 0;            // [rad] that it springs back to; > 0 bulges towards the normals
};

/// A sheet of paper at one moment: the flat pattern and where it is in space.
struct Sheet {
  Points2 pattern;      // |V|x2 [m]    flat rest shape
  Points3 x;            // |V|x3 [m]    where the vertices are now
  Points3 v;            // |V|x3 [m/s]
  Triangles triangles;  // |T|x3        counter-clockwise in the pattern
  // apices in order of birth; paper does not heal, so it only grows
  std::vector<SingularPoint> singular;
  std::vector<PrescribedCrease> prescribed_creases = {};  // the same in all frames
};

}  // namespace paperbake
