#include "core/step3_developable/developable.h"

#include "core/geometry/measure.h"
#include "core/geometry/random.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A rolled sheet whose vertices are displaced at random, by at most `noise` [m] along each axis.
Sheet noisy_roll(double noise) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10, 0.2);
  test::roll(sheet, 0.06);
  for (int v = 0; v < sheet.x.rows(); ++v)
    for (int c = 0; c < 3; ++c) sheet.x(v, c) += noise * uniform(7, 3 * v + c);
  return sheet;
}

TEST(DevelopableTest, RestoredSheetHasTheLengthsAndAnglesOfItsPattern) {
  Sheet sheet = noisy_roll(4e-5);
  const double defect = angle_defect_max(sheet);
  const Points3 before = sheet.x;
  ASSERT_GT(length_distortion(sheet).largest, 0.002);
  DevelopableOptions all;
  all.left_alone = 0;
  all.max_iterations = 20;
  all.max_move = 0.05;
  const Restored restored = restore_lengths(sheet, {}, all);
  EXPECT_LT(length_distortion(sheet).largest, 0.1 * restored.before);
  EXPECT_LT(angle_defect_max(sheet), 0.1 * defect);  // with the true lengths come the true angles
  EXPECT_NEAR(restored.after, length_distortion(sheet).largest, 1e-12);
  EXPECT_NEAR(restored.moved, (sheet.x - before).rowwise().norm().maxCoeff(), 1e-15);
  EXPECT_LT(restored.moved, 5e-4);  // the shape is the same
}

TEST(DevelopableTest, SmallLengthErrorsAreLeftAlone) {
  Sheet sheet = noisy_roll(4e-5);
  const Points3 before = sheet.x;
  DevelopableOptions lax;
  lax.left_alone = 0.1;
  EXPECT_EQ(restore_lengths(sheet, {}, lax).iterations, 0);
  EXPECT_TRUE(sheet.x == before);
  // larger errors are corrected, but only down to what is left alone
  restore_lengths(sheet, {});
  const double largest = length_distortion(sheet).largest;
  EXPECT_LT(largest, 2 * DevelopableOptions{}.left_alone);
  EXPECT_GT(largest, 0.5 * DevelopableOptions{}.left_alone);
}

TEST(DevelopableTest, HeldVerticesStayAndExcessStretchIsShared) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);  // flat, two borders 0.4 % too far apart
  std::vector<int> held;
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const bool left = sheet.pattern(v, 0)<1e-9, right = sheet.pattern(v, 0)> 0.1 - 1e-9;
    if (left || right) held.push_back(v);
    if (right) sheet.x(v, 0) += 0.0004;
  }
  const Points3 before = sheet.x;
  ASSERT_GT(length_distortion(sheet).largest, 0.02);  // all of it is in the last row
  restore_lengths(sheet, held);
  for (const int v : held) EXPECT_TRUE(sheet.x.row(v) == before.row(v));
  EXPECT_LT(length_distortion(sheet).largest, 0.006);  // 0.4 % everywhere is the least possible
}

TEST(DevelopableTest, NoVertexMovesFartherThanAllowed) {
  Sheet sheet = noisy_roll(2e-3);
  DevelopableOptions options;
  options.max_move = 1e-4;
  EXPECT_LE(restore_lengths(sheet, {}, options).moved, 1e-4 * std::sqrt(2) * 0.1 * (1 + 1e-9));
}

TEST(DevelopableTest, SheetHeldEverywhereStays) {
  Sheet sheet = noisy_roll(2e-3);
  std::vector<int> all(sheet.x.rows());
  for (int v = 0; v < sheet.x.rows(); ++v) all[v] = v;
  const Points3 before = sheet.x;
  const Restored restored = restore_lengths(sheet, all);
  EXPECT_TRUE(sheet.x == before);
  EXPECT_EQ(restored.before, restored.after);
}

}  // namespace
}  // namespace paperbake
