#include "core/step2_crumple/conflicts.h"

#include "core/geometry/curvature.h"
#include "tests/core/step2_crumple/ridge_and_valley.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

TEST(ConflictsTest, SaddleHasConflictsAndACylinderHasNone) {
  Sheet cylinder = test::hex_sheet(0.1, 0.1, 10);
  test::roll(cylinder, 0.03);
  Sheet saddle = test::hex_sheet(0.1, 0.1, 10);
  for (int v = 0; v < saddle.x.rows(); ++v) {
    const double a = saddle.pattern(v, 0) - 0.05, b = saddle.pattern(v, 1) - 0.05;
    // curvatures of +-24 1/m, in steps of a centimetre: 12 degrees in each direction
    saddle.x(v, 2) = 12 * (a * a - b * b);
  }
  const std::vector<char> none;
  const Conflicts smooth = find_conflicts(cylinder, vertex_curvature(cylinder), none, {});
  EXPECT_EQ(std::count(smooth.exceeds.begin(), smooth.exceeds.end(), 1), 0);
  const Conflicts torn = find_conflicts(saddle, vertex_curvature(saddle), none, {});
  EXPECT_GT(std::count(torn.exceeds.begin(), torn.exceeds.end(), 1), 20);
  const std::vector<char> all(saddle.pattern.rows(), 1);
  const Conflicts held = find_conflicts(saddle, vertex_curvature(saddle), all, {});
  EXPECT_EQ(std::count(held.exceeds.begin(), held.exceeds.end(), 1), 0);
}

TEST(ConflictsTest, ConflictShowsWhereFoldsOfBothSignsMeet) {
  Sheet sheet = test::ridge_and_valley();
  const Points3 curvature = vertex_curvature(sheet);
  CrumpleOptions folds_alone;
  folds_alone.conflict_turn = folds_alone.threshold_near_apex = 10;
  const auto count = [&](const CrumpleOptions& options) {
    const Conflicts c = find_conflicts(sheet, curvature, {}, options);
    return std::count(c.exceeds.begin(), c.exceeds.end(), 1);
  };
  EXPECT_GE(count(folds_alone), 1);
  const Conflicts c = find_conflicts(sheet, curvature, {}, folds_alone);
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (!c.exceeds[v]) continue;
    // near the middle, not all along the crease
    EXPECT_LT((sheet.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm(), 0.021);
  }
  CrumpleOptions blind = folds_alone;
  blind.conflict_folds = blind.fold_threshold_near_apex = 10;
  EXPECT_EQ(count(blind), 0);
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (c.exceeds[v]) sheet.singular.push_back({sheet.pattern.row(v).transpose(), 1, "test"});
  CrumpleOptions greedy = folds_alone;
  greedy.fold_threshold_near_apex = 0.01;
  EXPECT_GT(count(greedy), count(folds_alone));  // next to a singular point
}

TEST(ConflictsTest, ThresholdsAreHigherNextToASingularPoint) {
  Sheet saddle = test::hex_sheet(0.1, 0.1, 10);
  for (int v = 0; v < saddle.x.rows(); ++v) {
    const double a = saddle.pattern(v, 0) - 0.05, b = saddle.pattern(v, 1) - 0.05;
    saddle.x(v, 2) = 12 * (a * a - b * b);
  }
  int inner = 0;
  for (int v = 0; v < saddle.pattern.rows(); ++v)
    if ((saddle.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm() <
        (saddle.pattern.row(inner) - Eigen::RowVector2d(0.05, 0.05)).norm())
      inner = v;
  saddle.singular.push_back({saddle.pattern.row(inner).transpose(), 1, "test"});
  const auto exceeds = [&](double threshold_near_apex) {
    CrumpleOptions options;
    options.threshold_near_apex = threshold_near_apex;
    const Conflicts c = find_conflicts(saddle, vertex_curvature(saddle), {}, options);
    return std::count(c.exceeds.begin(), c.exceeds.end(), 1);
  };
  EXPECT_EQ(exceeds(0.14) - exceeds(1.0), 6);  // the six neighbours of the point in the lattice
}

TEST(ConflictsTest, MiddleOfAConflictIsWhereTheSheetBulgesNotTheWorstVertex) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  const Vector2d core_weight(0.043, 0.052);
  // a dome of 12 mm with positive Gaussian curvature inside and negative curvature around it
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) =
        0.004 * std::exp(-(sheet.pattern.row(v).transpose() - core_weight).squaredNorm() /
                         (2 * 0.012 * 0.012));
  const Conflicts conflicts = find_conflicts(sheet, vertex_curvature(sheet), {}, {});
  std::vector<int> members;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (conflicts.exceeds[v]) members.push_back(v);
  ASSERT_FALSE(members.empty());
  const int worst = *std::max_element(members.begin(), members.end(), [&](int a, int b) {
    return conflicts.turn[a] < conflicts.turn[b];
  });
  EXPECT_GT((sheet.pattern.row(worst).transpose() - core_weight).norm(), 0.002);  // cells of 10 mm
  EXPECT_LT((middle_of_conflict(sheet, conflicts, members) - core_weight).norm(), 0.0015);

  Conflicts saddle = conflicts;  // where nothing bulges, the turning angles decide
  std::fill(saddle.core_weight.begin(), saddle.core_weight.end(), 0.0);
  EXPECT_LT(
      (middle_of_conflict(sheet, saddle, {worst}) - sheet.pattern.row(worst).transpose()).norm(),
      1e-12);
}

}  // namespace
}  // namespace paperbake
