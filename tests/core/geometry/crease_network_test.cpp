#include "core/geometry/crease_network.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// A strip of n cells along x, folded by `angle` [rad] at the given columns.
Sheet folded(int n, const std::vector<int>& columns, double angle) {
  Sheet sheet = test::strip_sheet(0.1, 0.05, n);
  double turn = 0, x = 0, z = 0;
  for (int i = 0; i <= n; ++i) {
    for (int k : {0, 1}) sheet.x.row(2 * i + k) << x, sheet.pattern(2 * i + k, 1), z;
    if (std::find(columns.begin(), columns.end(), i) != columns.end()) turn += angle;
    x += 0.1 / n * std::cos(turn);
    z += 0.1 / n * std::sin(turn);
  }
  return sheet;
}

TEST(CreaseNetworkTest, FoldAcrossAStripIsOneCreaseOfItsWidth) {
  const CreaseNetwork one = crease_network(folded(6, {3}, 0.5));
  EXPECT_NEAR(one.length, 0.05, 1e-12);
  EXPECT_NEAR(one.count, 1, 1e-12);
  ASSERT_EQ(one.creases.size(), 1u);
  EXPECT_NEAR(one.creases[0], 0.05, 1e-12);
  const CreaseNetwork two = crease_network(folded(6, {2, 4}, -0.5));
  EXPECT_NEAR(two.length, 0.1, 1e-12);
  EXPECT_NEAR(two.mean(), 0.05, 1e-12);
}

TEST(CreaseNetworkTest, FoldOfLessThanTwentyDegreesIsNoCrease) {
  EXPECT_EQ(crease_network(folded(6, {1, 2, 3, 4, 5}, 0.3)).length, 0);
}

TEST(CreaseNetworkTest, SingularPointDividesACreaseInTwo) {
  Sheet sheet = test::hex_sheet(0.1, 0.0866, 10);  // rows of edges along x
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double over = sheet.pattern(v, 1) - 0.0433;
    if (over > 0)
      sheet.x.row(v) << sheet.pattern(v, 0), 0.0433 + over * std::cos(1.0), over * std::sin(1.0);
  }
  const CreaseNetwork whole = crease_network(sheet);
  ASSERT_NEAR(whole.count, 1, 1e-12);
  ASSERT_EQ(whole.creases.size(), 1u);
  EXPECT_NEAR(whole.creases[0], whole.length, 1e-12);
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (std::abs(sheet.pattern(v, 1) - 0.0433) < 1e-4 &&
        std::abs(sheet.pattern(v, 0) - 0.05) < 0.006) {
      sheet.singular.push_back({sheet.pattern.row(v).transpose(), 1, "test"});
      break;
    }
  ASSERT_EQ(sheet.singular.size(), 1u);
  EXPECT_NEAR(crease_network(sheet).count, 2, 1e-12);
  EXPECT_EQ(crease_network(sheet).length, whole.length);
  const std::vector<double> halves = crease_network(sheet).creases;
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_NEAR(halves[0] + halves[1], whole.length, 1e-12);
  EXPECT_NEAR(halves[0], 0.05, 0.006);
}

}  // namespace
}  // namespace paperbake
