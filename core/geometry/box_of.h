#pragma once

#include "core/model/sheet.h"

#include <Eigen/Geometry>

#include <array>

namespace paperbake {

/// The smallest axis-aligned box around these points; there is one at least. [m]
inline Eigen::AlignedBox3d box_of(const Points3& x) {
  return {Vector3d(x.colwise().minCoeff().transpose()),
          Vector3d(x.colwise().maxCoeff().transpose())};
}

/// The same of the corners of a triangle.
inline Eigen::AlignedBox3d box_of(const std::array<Vector3d, 3>& corners) {
  return Eigen::AlignedBox3d(corners[0]).extend(corners[1]).extend(corners[2]);
}

/// A box that reaches farther to all sides. by  [m]
inline Eigen::AlignedBox3d grown(Eigen::AlignedBox3d box, double by) {
  box.min().array() -= by;
  box.max().array() += by;
  return box;
}

}  // namespace paperbake
