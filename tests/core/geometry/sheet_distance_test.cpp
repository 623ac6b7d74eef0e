#include "core/geometry/sheet_distance.h"
#include "core/geometry/intersections.h"

#include "core/geometry/measure.h"
#include "core/geometry/proximity.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A rotated sheet, moved away from the origin by about `away` [m].
Sheet placed(unsigned seed, double away) {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 6, 0.2, seed);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(seed, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x.row(v) = turn * (sheet.x.row(v).transpose() - Vector3d(0.05, 0.03, 0)) +
                     Vector3d(away, 0.3 * away, 0);
  return sheet;
}

TEST(SheetDistanceTest, DistanceIsTheLeastOverAllPairsOfFeatures) {
  int known = 0, crossed = 0;
  for (unsigned seed = 1; seed < 20; ++seed) {
    const Sheet a = placed(seed, 0), b = placed(seed + 30, 0.01 * seed);
    double least = 1;
    for (int s = 0; s < a.triangles.rows(); ++s)
      for (int t = 0; t < b.triangles.rows(); ++t) {
        const auto p = [&](int i) -> Vector3d { return a.x.row(a.triangles(s, i % 3)); };
        const auto q = [&](int i) -> Vector3d { return b.x.row(b.triangles(t, i % 3)); };
        for (int i = 0; i < 3; ++i) {
          least = std::min({least, vertex_to_triangle({p(i), q(0), q(1), q(2)}).distance(),
                            vertex_to_triangle({q(i), p(0), p(1), p(2)}).distance()});
          for (int j = 0; j < 3; ++j)
            least = std::min(least, edge_to_edge({p(i), p(i + 1), q(j), q(j + 1)}).distance());
        }
      }
    if (crossings_between(a, b) > 0) {
      least = 0;
      ++crossed;
    }
    ++known;
    EXPECT_DOUBLE_EQ(distance_between(a, b, 1), least) << seed;
    EXPECT_EQ(distance_between(a, b, 0.5 * least), 0.5 * least) << seed;
  }
  EXPECT_GT(crossed, 2);
  EXPECT_GT(known - crossed, 2);
}

TEST(SheetDistanceTest, FractionOfNearVerticesIsCountedOnBothSheets) {
  Sheet a = test::hex_sheet(0.1, 0.1, 6, 0.2, 1), b = a;
  b.x.col(2).array() += 1e-4;
  EXPECT_EQ(share_within(a, b, 2e-4), 1);
  EXPECT_EQ(share_within(a, b, 5e-5), 0);
  b.x.col(0).array() += 0.05;
  EXPECT_NEAR(share_within(a, b, 2e-4), 0.5, 0.15);
}

TEST(SheetDistanceTest, SheetsWithACommonBorderAreApartInside) {
  const Pattern square = test::rectangle(0.1, 0.1);
  const Sheet a = test::hex_sheet(0.1, 0.1, 6, 0.2, 1);
  Sheet above = a, beside = a;
  above.x.col(2).array() += 3e-5;
  above.x.col(0).array() += 0.06;
  beside.x.col(0).array() += 0.1;
  EXPECT_NEAR(distance_of_inside(square, a, above, 1e-4), 3e-5, 1e-12);
  EXPECT_EQ(distance_of_inside(square, a, above, 2e-5), 2e-5);
  EXPECT_EQ(distance_between(a, beside, 1e-4), 0);
  EXPECT_EQ(distance_of_inside(square, a, beside, 1e-4), 1e-4);
  // two halves of a square, with its diagonal in common
  const Pattern half{{{0, 0}, {0.1, 0}, {0, 0.1}}, {}};
  Sheet left;
  left.pattern = (Points2(3, 2) << 0, 0, 0.1, 0, 0, 0.1).finished();
  left.triangles = (Triangles(1, 3) << 0, 1, 2).finished();
  left.x = (Points3(3, 3) << 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0).finished();
  Sheet right = left;
  right.x.row(0) << 0.1, 0.1, 0;
  EXPECT_EQ(distance_of_inside(half, left, right, 1e-4), 1e-4);
}

TEST(SheetDistanceTest, IntersectionsOfTwoSheetsAreThoseBetweenTheirTriangles) {
  Sheet a = test::hex_sheet(0.1, 0.1, 6, 0.2, 1), b = a;
  for (int v = 0; v < b.x.rows(); ++v)
    b.x.row(v) << 0.05, b.pattern(v, 0) + 1e-3, b.pattern(v, 1) - 0.05;
  Sheet both = a;
  const int n = static_cast<int>(a.x.rows());
  both.x.conservativeResize(2 * n, 3);
  both.x.bottomRows(n) = b.x;
  both.triangles.conservativeResize(2 * a.triangles.rows(), 3);
  both.triangles.bottomRows(a.triangles.rows()) = b.triangles.array() + n;
  EXPECT_GT(crossings_between(a, b), 5);
  EXPECT_EQ(crossings_between(a, b), crossings(both));
}

}  // namespace
}  // namespace paperbake
