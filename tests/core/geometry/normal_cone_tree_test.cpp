#include "core/geometry/normal_cone_tree.h"

#include "core/geometry/intersections.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace paperbake {
namespace {

using Pairs = std::set<std::pair<int, int>>;

Pairs in_order(const std::vector<std::pair<int, int>>& pairs) {
  Pairs sorted;
  for (const auto& [a, b] : pairs) sorted.insert(std::minmax(a, b));
  return sorted;
}

Pairs near(const Sheet& sheet, const Points3& y) {
  return in_order(NormalConeTree(sheet.pattern, sheet.triangles).near(sheet.x, y));
}

/// Two sheets as one mesh. Their patterns overlap.
Sheet together(const Sheet& a, const Sheet& b) {
  Sheet both;
  both.pattern.resize(a.pattern.rows() + b.pattern.rows(), 2);
  both.pattern << a.pattern, b.pattern;
  both.x.resize(both.pattern.rows(), 3);
  both.x << a.x, b.x;
  both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
  both.triangles << a.triangles, b.triangles.array() + static_cast<int>(a.x.rows());
  return both;
}

/// A strip that is rolled so tightly that it passes through itself: its radius grows and shrinks.
Sheet strip_through_itself() {
  Sheet sheet = test::strip_sheet(0.3, 0.03, 120);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double angle = 15 * sheet.pattern(v, 0) / 0.3,
                 radius = 0.02 + 0.004 * std::sin(2.5 * angle);
    sheet.x.row(v) << radius * std::cos(angle), sheet.pattern(v, 1), radius * std::sin(angle);
  }
  return sheet;
}

TEST(NormalConeTreeTest, ASheetWhoseNormalsLieInOneHalfSpaceNeedsNoLook) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 12, 0.2);
  EXPECT_TRUE(near(sheet, sheet.x).empty()) << "flat";
  test::roll(sheet, 0.05);  // by 115 degrees
  EXPECT_TRUE(near(sheet, sheet.x).empty());
}

TEST(NormalConeTreeTest, FindsAllTrianglesOfARollThatIntersect) {
  const Sheet sheet = strip_through_itself();
  const Pairs crossing = in_order(CrossingCounter(sheet.pattern, sheet.triangles).pairs(sheet.x));
  ASSERT_GT(crossing.size(), 20u);
  const Pairs found = near(sheet, sheet.x);
  EXPECT_TRUE(std::includes(found.begin(), found.end(), crossing.begin(), crossing.end()));
  // and few of all
  const auto n = static_cast<double>(sheet.triangles.rows());
  EXPECT_LT(static_cast<double>(found.size()), 0.05 * n * (n - 1) / 2);
}

TEST(NormalConeTreeTest, SheetsThatFaceTheSameWayAreNotNeighbours) {
  Sheet upper = test::hex_sheet(0.1, 0.1, 6, 0.1);
  const Sheet lower = upper;
  const int n = static_cast<int>(upper.triangles.rows());
  const auto between = [n](const Pairs& pairs) {
    return std::count_if(pairs.begin(), pairs.end(),
                         [n](const auto& pair) { return pair.first < n && pair.second >= n; });
  };
  upper.x.col(2).array() += 0.02;
  const Sheet apart = together(lower, upper);
  EXPECT_EQ(between(near(apart, apart.x)), 0);
  upper.x.col(2).array() -= 0.02;
  const Sheet in_touch = together(lower, upper);
  EXPECT_GE(between(near(in_touch, in_touch.x)), n);
}

TEST(NormalConeTreeTest, FindsWhatAWayPassesThrough) {
  Sheet upper = test::hex_sheet(0.1, 0.1, 6, 0.1);
  const Sheet lower = upper;
  upper.x.col(2).array() += 0.02;
  const Sheet start = together(lower, upper);
  Points3 end = start.x;
  end.bottomRows(upper.x.rows()).col(2).array() -= 0.04;  // at neither end they touch
  const Sheet there = [&] {
    Sheet moved = start;
    moved.x = end;
    return moved;
  }();
  ASSERT_TRUE(near(there, there.x).empty());
  EXPECT_GE(near(start, end).size(), static_cast<std::size_t>(upper.triangles.rows()));
}

TEST(NormalConeTreeTest, LeavesOutTrianglesWithACommonEdge) {
  const Sheet sheet = strip_through_itself();
  const Pairs found = near(sheet, sheet.x);
  ASSERT_FALSE(found.empty());
  for (const auto& [a, b] : found) {
    int common = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) common += sheet.triangles(a, i) == sheet.triangles(b, j);
    EXPECT_LT(common, 2) << a << " and " << b;
  }
}

}  // namespace
}  // namespace paperbake
