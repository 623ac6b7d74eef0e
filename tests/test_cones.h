#pragma once

#include "tests/test_meshes.h"

namespace paperbake::test {

/// Bends a sheet to a right circular cone, without stretching it: apex on the pattern, slope of the generators against the axis.
/// Its curvature is 1/(tan(slope) r) at a distance r from the apex; it bulges towards its normal.
inline void bend_to_cone(Sheet& sheet, const Vector2d& apex, double slope) {
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Vector2d d = sheet.pattern.row(v).transpose() - apex;
    const double r = d.norm(), phi = std::atan2(d.y(), d.x()) / std::sin(slope);
    sheet.x.row(v) << r * std::sin(slope) * std::cos(phi), r * std::sin(slope) * std::sin(phi), -r * std::cos(slope);
  }
}

}  // namespace paperbake::test
