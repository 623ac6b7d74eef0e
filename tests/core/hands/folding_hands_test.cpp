#include "core/hands/folding_hands.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <limits>

namespace paperbake {
namespace {

constexpr double degrees = M_PI / 180;

constexpr double side = 0.1;  // [m] of the sheet
constexpr double nobody = std::numeric_limits<double>::quiet_NaN();

constexpr double middle = side / 2;
const Segment2 upright{{middle, 0}, {middle, side}}, level{{0, middle}, {side, middle}};

/// A square of 4 x 4 cells with a crease along x = side/2 and one along y = side/2.
Sheet crossed_sheet() {
  Points2 p(25, 2);
  Triangles t(32, 3);
  for (int j = 0, k = 0; j <= 4; ++j)
    for (int i = 0; i <= 4; ++i) {
      p.row(5 * j + i) << side * i / 4, side * j / 4;
      if (i == 4 || j == 4) continue;
      const int a = 5 * j + i;
      t.row(k++) << a, a + 1, a + 6;
      t.row(k++) << a, a + 6, a + 5;
    }
  Sheet sheet = test::flat_sheet(p, t);
  sheet.prescribed_creases = {{{{middle, 0}, {middle, side}}, 0, false},
                              {{{0, middle}, {side, middle}}, 0, false}};
  return sheet;
}

/// Calls test(crease, centre, edge) for the edges of both creases.
template <class Test>
void for_edges(const Sheet& sheet, const Test& test) {
  ASSERT_EQ(sheet.crease_edges.size(), 8u);
  for (const CreaseEdge& edge : sheet.crease_edges)
    test(edge.a.x() == edge.b.x() ? 0 : 1, Vector2d(0.5 * (edge.a + edge.b)), edge);
}

TEST(FoldingHandsTest, HandsPressTheirWholeCreaseToTheAngleBetweenThem) {
  Sheet sheet = crossed_sheet();
  const std::vector<FoldingHands> hands{
      {upright, {upright}, {0.0, 2 * degrees, -1.5, nobody, 0.01}, {side / 2, 0.01}}};
  for (int row = 0; row < 7; ++row) {
    fold_by_hands(sheet, hands, row);
    for_edges(sheet, [&](int crease, const Vector2d&, const CreaseEdge& edge) {
      EXPECT_EQ(edge.folded, crease == 0 && row >= 2) << row;
      EXPECT_EQ(edge.pressed.has_value(), crease == 0 && row >= 2 && row != 3) << row;
      if (edge.pressed) {
        EXPECT_EQ(*edge.pressed, row == 2 ? -1.5 : 0.01) << "the last turn is kept";
      }
      EXPECT_EQ(edge.rest_angle, 0) << "what the paper keeps is not for hands to say";
    });
  }
}

TEST(FoldingHandsTest, OnlyThePartsOfADrawnCreaseThatRunAlongTheLineArePressed) {
  Sheet sheet = crossed_sheet();
  const Vector2d centre(middle, middle);
  sheet.prescribed_creases = {{{{middle, 0}, centre, {side, middle}}}, {{{0, middle}, centre}}};
  const Segment2 part{{middle, 0}, centre};
  fold_by_hands(sheet, {{upright, {part}, {-1.0}, {middle, 0.01}}}, 0);
  int pressed = 0;
  for (const CreaseEdge& edge : sheet.crease_edges) {
    EXPECT_EQ(edge.pressed.has_value(), edge.a.x() == middle && edge.b.x() == middle);
    pressed += edge.pressed.has_value();
  }
  EXPECT_EQ(pressed, 2);
}

TEST(FoldingHandsTest, WithoutHandsNothingIsPressed) {
  Sheet sheet = crossed_sheet();
  fold_by_hands(sheet, {}, 3);
  EXPECT_TRUE(sheet.crease_edges.empty());
}

/// The sheet is folded along x = side/2, shut; then across, with a hand on the left half.
const std::vector<FoldingHands> one_after_the_other{
    {upright, {upright}, {0, -1.0, -3.1, -3.1, -3.1, -3.1}, {side / 2, 0.01}},
    {level, {level}, {0, 0, 0, -1.0, -2.0, -3.1}, {0.01, side / 2}}};

TEST(FoldingHandsTest, ASecondFoldTurnsTheOtherWayBeyondAFirstOneThatIsShut) {
  Sheet sheet = crossed_sheet();
  for (int row = 0; row < 6; ++row) {
    fold_by_hands(sheet, one_after_the_other, row);
    if (row < 3) continue;
    for_edges(sheet, [&](int crease, const Vector2d& at, const CreaseEdge& edge) {
      if (crease == 0) return;
      const double turn = one_after_the_other[1].turn[row];
      EXPECT_TRUE(edge.folded);
      ASSERT_TRUE(edge.pressed);
      EXPECT_EQ(*edge.pressed, at.x() < side / 2 ? turn : -turn) << row << " " << at.x();
    });
  }
}

TEST(FoldingHandsTest, AFirstFoldKeepsItsSignWhileASecondOneShutsAcrossIt) {
  Sheet sheet = crossed_sheet();
  for (int row = 0; row < 6; ++row) {
    fold_by_hands(sheet, one_after_the_other, row);
    for_edges(sheet, [&](int crease, const Vector2d& at, const CreaseEdge& edge) {
      if (crease == 1 || row == 0) return;
      ASSERT_TRUE(edge.pressed);
      // three of the four lines that meet turn one way, and one the other (Maekawa)
      EXPECT_EQ(*edge.pressed, one_after_the_other[0].turn[row]) << row << " " << at.y();
    });
  }
}

TEST(FoldingHandsTest, AFoldAcrossOneThatHasBeenOpenedAgainTurnsOneWay) {
  Sheet sheet = crossed_sheet();
  const std::vector<FoldingHands> hands{{upright, {upright}, {0, -3.1, 0, 0, 0}, {side / 2, 0.01}},
                                        {level, {level}, {0, 0, 0, -1.0, -3.1}, {0.01, side / 2}}};
  for (int row = 3; row < 5; ++row) {
    fold_by_hands(sheet, hands, row);
    for_edges(sheet, [&](int crease, const Vector2d&, const CreaseEdge& edge) {
      ASSERT_TRUE(crease == 0 || edge.pressed);
      if (crease == 1) {
        EXPECT_EQ(*edge.pressed, hands[1].turn[row]);
      }
    });
  }
}

TEST(FoldingHandsTest, WhatThePaperHasKeptSurvivesTheHands) {
  Sheet sheet = crossed_sheet();
  sheet.crease_edges = {{{side / 2, 0}, {side / 2, side}, -2.0, true, -3.0}};
  fold_by_hands(sheet, {{upright, {upright}, {nobody}, {side / 2, 0.01}}}, 0);
  for_edges(sheet, [&](int crease, const Vector2d&, const CreaseEdge& edge) {
    EXPECT_EQ(edge.folded, crease == 0);
    EXPECT_EQ(edge.rest_angle, crease == 0 ? -2.0 : 0.0);
    EXPECT_FALSE(edge.pressed) << "nobody holds it any longer";
  });
}

}  // namespace
}  // namespace paperbake
