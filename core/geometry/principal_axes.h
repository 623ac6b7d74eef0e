#pragma once

#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/sheet.h"

namespace paperbake {

/// Principal axes of points: eigenvectors of sum_k (x_k - mean)(x_k - mean)^T. The first is the
/// normal of the plane nearest to the points.
///
/// x        n x 3 [m]
/// returns  values [m2]: summed squares of the distances from the mean, along the axes
SymmetricEigen<3> principal_axes(const Points3& x);

}  // namespace paperbake
