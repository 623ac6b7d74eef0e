#include "core/geometry/pattern_samples.h"

#include "core/geometry/measure.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

const Pattern rectangle{{{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}}, {}};

TEST(PatternSamplesTest, DifferentMeshesOfOneFlatSheetGiveTheSameSamples) {
  const PatternSamples samples(rectangle);
  const Sheet strip = test::strip_sheet(0.2, 0.1, 5);
  const Points3 coarse = samples(strip), fine = samples(test::hex_sheet(0.2, 0.1, 17, 0.2));
  ASSERT_EQ(coarse.rows(), 41 * 41);
  EXPECT_LT(rms_distance(coarse, fine), 1e-15);
  EXPECT_LT((samples.normals(strip).col(2).array() - 1).abs().maxCoeff(), 1e-12);
}

TEST(PatternSamplesTest, DistanceToAMovedSheetIsHowFarItMoved) {
  const PatternSamples samples(rectangle);
  Sheet moved = test::strip_sheet(0.2, 0.1, 5);
  const Points3 before = samples(moved);
  moved.x.rowwise() += Eigen::RowVector3d(0.001, 0.002, -0.002);
  EXPECT_NEAR(rms_distance(before, samples(moved)), 0.003, 1e-15);
}

TEST(PatternSamplesTest, PointsInAHoleDoNotCount) {
  Pattern holed = rectangle;
  holed.holes = {{{0.05, 0.025}, {0.05, 0.075}, {0.15, 0.075}, {0.15, 0.025}}};
  const Points3 sampled = PatternSamples(holed)(test::strip_sheet(0.2, 0.1, 5));
  // points 11 ... 29 of either axis lie strictly inside
  EXPECT_EQ(sampled.rows(), 41 * 41 - 19 * 19);
}

}  // namespace
}  // namespace paperbake
