#include "core/geometry/principal_axes.h"

namespace paperbake {

SymmetricEigen<3> principal_axes(const Points3& x) {
  const Points3 apart = x.rowwise() - x.colwise().mean().eval();
  return symmetric_eigen(Eigen::Matrix3d(apart.transpose() * apart));
}

}  // namespace paperbake
