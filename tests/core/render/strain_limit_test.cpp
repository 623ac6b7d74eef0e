#include "core/render/strain_limit.h"

#include "core/geometry/measure.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// A sheet folded by 90 degrees along a line that is not along the edges of its mesh.
Sheet cut_by_a_fold() {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 50, 0.1);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0) - 0.0507;
    sheet.x.row(v) << std::min(s, 0.0), sheet.pattern(v, 1), -std::max(s, 0.0);
  }
  return sheet;
}

TEST(StrainLimitTest, BringsEdgesCutByAFoldBackToTheLimit) {
  Sheet sheet = cut_by_a_fold();
  // 1 - 1/sqrt 2 where the fold halves an edge
  ASSERT_GT(length_distortion(sheet).largest, 0.2);
  StrainLimitOptions options;
  options.sweeps = 400;  // as many as needed: both sides are pushed apart as a whole
  StrainLimit(sheet.pattern, sheet.triangles, options)(sheet.x,
                                                       std::vector<char>(sheet.x.rows(), 0));
  EXPECT_LT(length_distortion(sheet).largest, 1.01 * options.limit);
}

TEST(StrainLimitTest, LeavesWhatIsWithinTheLimitToTheLastBit) {
  Sheet sheet = cut_by_a_fold();
  const Points3 before = sheet.x;
  StrainLimit(sheet.pattern, sheet.triangles, {})(sheet.x, std::vector<char>(sheet.x.rows(), 0));
  double moved = 0;
  for (int v = 0; v < before.rows(); ++v) {
    const double off = (sheet.x.row(v) - before.row(v)).norm();
    moved = std::max(moved, off);
    // The 0.6 mm that are missing are made up at 2 % in each row, which takes 30 mm.
    if (std::abs(sheet.pattern(v, 0) - 0.0507) > 0.035) {
      EXPECT_EQ(off, 0);
    }
  }
  EXPECT_GT(moved, 1e-4);
}

TEST(StrainLimitTest, GoesOnWhereFewEdgesAreOffByLessThanTheLimit) {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 50, 0.1);
  const StrainLimit limit(sheet.pattern, sheet.triangles);
  const std::vector<char> free(sheet.x.rows(), 0);
  Sheet pulled = sheet, stretched = sheet;
  // one inner vertex by 1.5 % of an edge of 2 mm
  const int inner = static_cast<int>(sheet.x.rows() / 2);
  pulled.x(inner, 0) += 3e-5;
  ASSERT_GT(length_distortion(pulled).largest, 0.01);
  limit(pulled.x, free);
  EXPECT_LT(length_distortion(pulled).largest, 1.01 * StrainLimitOptions{}.aims.back());
  stretched.x *= 1.01;
  const Points3 before = stretched.x;
  limit(stretched.x, free);
  EXPECT_EQ(stretched.x, before) << "all edges are off by 1 %";
}

TEST(StrainLimitTest, HeldVerticesStayToTheLastBit) {
  Sheet sheet = cut_by_a_fold();
  const Points3 before = sheet.x;
  std::vector<char> held(sheet.x.rows(), 0);
  for (int v = 0; v < sheet.x.rows(); ++v) held[v] = sheet.pattern(v, 0) < 0.0507;
  StrainLimit(sheet.pattern, sheet.triangles, {})(sheet.x, held);
  double moved = 0;
  for (int v = 0; v < sheet.x.rows(); ++v) {
    if (held[v]) {
      EXPECT_EQ(Vector3d(sheet.x.row(v)), Vector3d(before.row(v)));
    }
    moved = std::max(moved, (sheet.x.row(v) - before.row(v)).norm());
  }
  EXPECT_GT(moved, 1e-4) << "the others give all the more";
}

TEST(StrainLimitTest, TheWorstEdgeMayBeTooLongOrTooShort) {
  Points2 pattern(3, 2);
  pattern << 0, 0, 0.1, 0, 0, 0.1;
  Triangles triangles(1, 3);
  triangles << 0, 1, 2;
  Points3 x(3, 3);
  x << 0, 0, 0, 0.103, 0, 0, 0, 0.092, 0;
  EXPECT_NEAR(StrainLimit(pattern, triangles).worst(x), 0.08, 1e-12);
}

}  // namespace
}  // namespace paperbake
