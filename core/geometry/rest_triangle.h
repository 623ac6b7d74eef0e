#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// A triangle of the pattern: gradients of its three linear shape functions, and its area.
struct RestTriangle {
  Eigen::Matrix<double, 3, 2> g;  // [1/m] row i: gradient of the function that is 1 at corner i
  double area;                    // [m2]
};
RestTriangle rest_triangle(const Points2& pattern, const Eigen::RowVector3i& corners);

}  // namespace paperbake
