#include "core/geometry/injective_patches.h"

#include "core/geometry/intersections.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace paperbake {
namespace {

using test::hex_sheet;
using Cells = InjectivePatches::Cells;

Cells all_cells(const InjectivePatches& patches, const Sheet& sheet) {
  Cells all = patches.of_triangle(0);
  for (int t = 1; t < sheet.triangles.rows(); ++t) all = all.joined(patches.of_triangle(t));
  return all;
}

/// A sheet of 0.1 m folded along the middle by this angle [rad].
Sheet folded(double angle) {
  Sheet sheet = hex_sheet(0.1, 0.1, 20);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double beyond = std::max(0.0, sheet.pattern(v, 0) - 0.05);
    sheet.x(v, 0) -= beyond * (1 - std::cos(angle));
    sheet.x(v, 2) += beyond * std::sin(angle);
  }
  return sheet;
}

bool is_proved(const Sheet& sheet) {
  const InjectivePatches patches(sheet.pattern, sheet.triangles);
  if (!patches.can_prove()) return false;
  return InjectivePatches::OfShape(patches, sheet.x).is_injective(all_cells(patches, sheet));
}

TEST(InjectivePatchesTest, FoldOfLessThanARightAngleIsProved) {
  EXPECT_TRUE(is_proved(folded(0)));
  // the fold cuts through triangles, whose gradients make the box a little larger
  EXPECT_TRUE(is_proved(folded(1.0)));
  // |F - B| reaches sigma_min(B) at a right angle
  EXPECT_FALSE(is_proved(folded(1.6)));
}

TEST(InjectivePatchesTest, PartsThatAreProvedDoNotIntersectThemselves) {
  int proved = 0, crossed = 0;
  std::mt19937 random(5);
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Sheet sheet = hex_sheet(0.1, 0.1, 16, 0.2, seed);
    std::uniform_real_distribution<double> uniform(-0.00006 * seed, 0.00006 * seed);
    for (int k = 0; k < sheet.x.size(); ++k) sheet.x.data()[k] += uniform(random);
    const InjectivePatches patches(sheet.pattern, sheet.triangles);
    ASSERT_TRUE(patches.can_prove());
    const InjectivePatches::OfShape shape(patches, sheet.x);
    const Cells all = all_cells(patches, sheet);
    std::uniform_int_distribution<int> column(0, all.right), row(0, all.top);
    for (int k = 0; k < 40; ++k) {
      const int a = column(random), b = column(random), c = row(random), d = row(random);
      const Cells part{std::min(a, b), std::min(c, d), std::max(a, b), std::max(c, d)};
      std::vector<int> inside;
      for (int t = 0; t < sheet.triangles.rows(); ++t)
        if (const Cells joined = part.joined(patches.of_triangle(t));
            joined.count() == part.count())
          inside.push_back(t);
      Sheet patch{{}, sheet.x, {}, Triangles(inside.size(), 3), {}};
      for (std::size_t t = 0; t < inside.size(); ++t)
        patch.triangles.row(t) = sheet.triangles.row(inside[t]);
      const int count = crossings(patch);  // has no pattern, so that nothing is taken as proved
      crossed += count > 0;
      if (!shape.is_injective(part)) continue;
      EXPECT_EQ(count, 0) << "seed " << seed;
      proved += inside.size() > 20;
    }
  }
  EXPECT_GT(proved, 200);
  EXPECT_GT(crossed, 200);
}

TEST(InjectivePatchesTest, StraightBorderRoundedTo32BitsIsConvexEnough) {
  Sheet sheet = hex_sheet(0.1, 0.1, 40);
  sheet.pattern = sheet.pattern.cast<float>().cast<double>();
  EXPECT_TRUE(is_proved(sheet));
}

TEST(InjectivePatchesTest, PatternWithAHoleOrANotchProvesNothing) {
  for (const Vector2d& hole : {Vector2d(0.05, 0.05), Vector2d(0.05, 0)}) {
    const Sheet sheet = hex_sheet(0.1, 0.1, 20);
    std::vector<int> kept;
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      Vector2d middle(0, 0);
      for (int i = 0; i < 3; ++i) middle += sheet.pattern.row(sheet.triangles(t, i)) / 3;
      if ((middle - hole).norm() > 0.02) kept.push_back(t);
    }
    Triangles rest(kept.size(), 3);
    for (std::size_t t = 0; t < kept.size(); ++t) rest.row(t) = sheet.triangles.row(kept[t]);
    ASSERT_LT(rest.rows(), sheet.triangles.rows());
    EXPECT_FALSE(InjectivePatches(sheet.pattern, rest).can_prove());
  }
}

TEST(InjectivePatchesTest, PatternThatOverlapsItselfProvesNothing) {
  // a second sheet in the same place: every gradient is the same, and they intersect everywhere
  const Sheet sheet = hex_sheet(0.1, 0.1, 8);
  const int n = static_cast<int>(sheet.x.rows());
  Points2 twice(2 * n, 2);
  twice << sheet.pattern, sheet.pattern;
  Triangles both(2 * sheet.triangles.rows(), 3);
  both << sheet.triangles, sheet.triangles.array() + n;
  EXPECT_FALSE(InjectivePatches(twice, both).can_prove());
}

TEST(InjectivePatchesTest, PositionThatIsNoNumberIsNotProved) {
  Sheet sheet = folded(0);
  ASSERT_TRUE(is_proved(sheet));
  sheet.x(sheet.x.rows() / 2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_proved(sheet));
}

}  // namespace
}  // namespace paperbake
