#include "formats/maps/crease_history.h"

#include "tests/formats/maps/crease_map_fixture.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

using test::flat_sheet;
using test::folded_sheet;
using test::rectangle;
using test::rolled;

const Pattern square = rectangle(0.1, 0.1);

DetectedCrease line(Vector2d from, Vector2d to, double strength) {
  DetectedCrease crease;
  crease.from = from;
  crease.to = to;
  crease.strength = strength;
  return crease;
}

TEST(CreaseHistory, TheEdgesOfAFoldAreCreasesAsStrongAsTheirAngle) {
  const std::vector<DetectedCrease> creases =
      detect_creases(folded_sheet(0.1, 0.1, 0.04, 0.06, 1.2), {}, square, {});
  ASSERT_EQ(creases.size(), 11u);  // 12 vertices on the fold
  double length = 0;
  int ends_on_border = 0;
  for (const DetectedCrease& c : creases) {
    EXPECT_NEAR(c.strength, 1.2 / (M_PI / 2), 1e-9);
    EXPECT_NEAR(c.from.x(), 0.04 + 0.2 * c.from.y(), 1e-12);
    length += (c.to - c.from).norm();
    ends_on_border += c.from_border + c.to_border;
  }
  EXPECT_NEAR(length, std::hypot(0.02, 0.1), 1e-12);
  EXPECT_EQ(ends_on_border, 2);
}

TEST(CreaseHistory, ARolledSheetHasNoCreasesOnACoarseMesh) {
  // 0.75 rad from row to row, but at 60 1/m the paper stays elastic
  const Sheet coarse = rolled(flat_sheet(0.1, 0.1, 0.0125), 60);
  EXPECT_TRUE(detect_creases(coarse, {}, square, {}).empty());
  CreaseThresholds soft;
  soft.yield_curvature = 10;  // this paper yields
  EXPECT_GT(detect_creases(coarse, {}, square, soft).size(), 20u);
}

TEST(CreaseHistory, WithPlasticityTheRemainingAngleDecides) {
  const Sheet sheet = folded_sheet(0.1, 0.1, 0.05, 0.05, 1.2);
  const Points3 none = Points3::Zero(sheet.pattern.rows(), 3);
  EXPECT_TRUE(detect_creases(sheet, none, square, {}).empty());
  EXPECT_EQ(
      detect_creases(sheet, test::tensors(sheet, [](Vector2d) { return 60.0; }), square, {}).size(),
      11u);
  // plastic curvature along the fold is no angle across it
  Points3 along = none;
  along.col(2).setConstant(60);
  EXPECT_TRUE(detect_creases(sheet, along, square, {}).empty());
}

TEST(CreaseHistory, ARepeatedCreaseIsStoredOnceAtItsStrongest) {
  std::vector<DetectedCrease> history;
  merge_creases(history, {line({0.01, 0.01}, {0.03, 0.02}, 0.4)}, 3, 2.5e-4);
  // reversed, 0.1 mm off, stronger
  merge_creases(history, {line({0.03, 0.02}, {0.0101, 0.01}, 0.7)}, 5, 2.5e-4);
  merge_creases(history, {line({0.01, 0.01}, {0.03, 0.02}, 0.5)}, 6, 2.5e-4);
  ASSERT_EQ(history.size(), 1u);
  EXPECT_EQ(history[0].strength, 0.7);
  EXPECT_EQ(history[0].frame_of_birth, 3);
  EXPECT_EQ(history[0].to.x(), 0.0101);
}

TEST(CreaseHistory, APartOfACreaseInheritsItsAge) {
  std::vector<DetectedCrease> history;
  merge_creases(history, {line({0, 0.05}, {0.1, 0.05}, 0.4)}, 3, 2.5e-4);
  merge_creases(history,
                {line({0, 0.05}, {0.04, 0.05}, 0.9), line({0.04, 0.05}, {0.08, 0.09}, 0.9),
                 line({0, 0.052}, {0.1, 0.052}, 0.9)},
                9, 2.5e-4);
  ASSERT_EQ(history.size(), 4u);
  EXPECT_EQ(history[1].frame_of_birth, 3);
  EXPECT_EQ(history[2].frame_of_birth, 9);  // another direction
  EXPECT_EQ(history[3].frame_of_birth, 9);  // parallel, but 2 mm off
}

}  // namespace
}  // namespace paperbake
