#pragma once

#include "core/model/sheet.h"

#include <Eigen/Geometry>

namespace paperbake {

/// The smallest axis-aligned box around these points; there is one at least. [m]
inline Eigen::AlignedBox3d box_of(const Points3& x) {
  return {Vector3d(x.colwise().minCoeff().transpose()),
          Vector3d(x.colwise().maxCoeff().transpose())};
}

}  // namespace paperbake
