#pragma once

#include "core/model/sheet.h"

#include <Eigen/Geometry>

namespace paperbake {

/// The smallest axis-aligned box around these points; there is one at least. [m]
inline Eigen::AlignedBox3d box_of(const Points3& x) {
  return {Vector3d(x.colwise().minCoeff().transpose()),
          Vector3d(x.colwise().maxCoeff().transpose())};
}

/// A box that reaches farther to all sides. by  [m]
inline Eigen::AlignedBox3d grown(Eigen::AlignedBox3d box, double by) {
  box.min().array() -= by;
  box.max().array() += by;
  return box;
}

}  // namespace paperbake
