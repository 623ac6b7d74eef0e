#pragma once

#include "tests/core/test_meshes.h"

#include <cmath>

namespace paperbake::test {

/// A crease along a row of edges that is a ridge on the right and a valley on the left; the two
/// meet in the middle.
inline Sheet ridge_and_valley() {
  Sheet sheet = hex_sheet(0.1, 0.1, 10);
  int middle = 0;
  (sheet.pattern.rowwise() - Eigen::RowVector2d(0.05, 0.05)).rowwise().norm().minCoeff(&middle);
  for (int v = 0; v < sheet.x.rows(); ++v)
    // 0.4 rad on the edges next to the middle
    sheet.x(v, 2) = 40 * std::abs(sheet.pattern(v, 1) - sheet.pattern(middle, 1)) *
                    (sheet.pattern(v, 0) - sheet.pattern(middle, 0));
  return sheet;
}

}  // namespace paperbake::test
