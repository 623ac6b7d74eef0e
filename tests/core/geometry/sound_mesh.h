#pragma once

#include "core/geometry/hinges.h"
#include "core/model/segment2.h"
#include "core/model/sheet.h"

#include <gtest/gtest.h>

namespace paperbake::test {

/// Twice the area of a triangle on the pattern, negative when the triangle is turned over. [m2]
inline double twice_area(const Sheet& sheet, int t) {
  const Vector2d a = sheet.pattern.row(sheet.triangles(t, 0)),
                 b = sheet.pattern.row(sheet.triangles(t, 1)),
                 c = sheet.pattern.row(sheet.triangles(t, 2));
  return cross(b - a, c - a);
}

/// Expects that the mesh covers a region of this area [m2], with the topology of a disc, exactly
/// once.
inline void expect_sound(const Sheet& sheet, double area) {
  double sum = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    EXPECT_GT(twice_area(sheet, t), 0) << t;
    sum += 0.5 * twice_area(sheet, t);
  }
  EXPECT_NEAR(sum, area, 1e-12);
  const Hinges hinges = find_hinges(sheet.triangles);  // throws when an edge has three triangles
  const long edges = (3 * sheet.triangles.rows() + static_cast<long>(hinges.hinges.size())) -
                     2 * static_cast<long>(hinges.hinges.size());
  EXPECT_EQ(sheet.pattern.rows() - edges + sheet.triangles.rows(), 1);  // Euler: a disc
}

}  // namespace paperbake::test
