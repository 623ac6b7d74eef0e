#include "baker/output/sheet_guides.h"

#include "tests/core/test_shots.h"
#include "tests/formats/maps/crease_map_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

AnimatedFrame frame_of(const Sheet& sheet, int number) {
  AnimatedFrame frame;
  frame.frame = number;
  frame.sheet = &sheet;
  return frame;
}

CacheFrame mesh_of(const Sheet& sheet) {
  CacheFrame mesh;
  mesh.x = sheet.x;
  mesh.triangles = sheet.triangles;
  mesh.uv = sheet.pattern / 0.1;
  return mesh;
}

class SheetGuidesTest : public testing::Test {
 protected:
  Shot shot_ = test::blank_shot(test::rectangle(0.1, 0.1));
  SheetGuides guides_{shot_};
};

TEST_F(SheetGuidesTest, FoldsLieOnTheMeshWithTheirAngleAndItsSign) {
  for (const double angle : {1.2, -1.2}) {
    SheetGuides guides(shot_);
    const Sheet sheet = test::folded_sheet(0.1, 0.1, 0.05, 0.05, angle);
    guides.add(frame_of(sheet, 3));
    const CacheGuides found = guides.at(3, mesh_of(sheet));
    ASSERT_EQ(found.fold_size.size(), 11u);
    int points = 0;
    for (const int size : found.fold_size) points += size;
    ASSERT_EQ(points, found.folds.rows());
    ASSERT_EQ(points, found.angle.size());
    double length = 0;
    for (int i = 0; i < points; ++i) {
      double nearest = 1;  // to a vertex of the fold
      for (Eigen::Index v = 0; v < sheet.x.rows(); ++v)
        if (std::abs(sheet.pattern(v, 0) - 0.05) < 1e-9)
          nearest = std::min(nearest, (sheet.x.row(v) - found.folds.row(i)).norm());
      EXPECT_LT(nearest, 0.5 * 0.1 / 11 + 1e-12);
      EXPECT_NEAR(found.folds(i, 0), 0, 1e-12);
      EXPECT_NEAR(found.folds(i, 2), 0, 1e-12);
      EXPECT_NEAR(found.angle[i], angle, 1e-9);
    }
    int first = 0;
    for (const int size : found.fold_size) {
      length += (found.folds.row(first + size - 1) - found.folds.row(first)).norm();
      first += size;
    }
    EXPECT_NEAR(length, 0.1, 1e-9);
  }
}

TEST_F(SheetGuidesTest, AFrameHasWhatWasBornUpToIt) {
  Sheet sheet = test::flat_sheet(0.1, 0.1, 0.01);
  guides_.add(frame_of(sheet, 1));
  sheet = test::folded_sheet(0.1, 0.1, 0.05, 0.05, 1.2);
  sheet.singular = {{Vector2d(0.03, 0.04), 2, "a"}};
  guides_.add(frame_of(sheet, 2));
  sheet = test::folded_sheet(0.1, 0.1, 0.02, 0.02, 1.2);
  sheet.singular = {{Vector2d(0.03, 0.04), 2, "a"}, {Vector2d(0.07, 0.05), 3, "b"}};
  guides_.add(frame_of(sheet, 3));
  const CacheFrame flat = mesh_of(test::flat_sheet(0.1, 0.1, 0.01));
  EXPECT_EQ(guides_.at(1, flat).fold_id.size() + guides_.at(1, flat).point_id.size(), 0u);
  const CacheGuides second = guides_.at(2, flat), third = guides_.at(3, flat);
  EXPECT_EQ(second.point_id, std::vector<int>{1});
  EXPECT_EQ(third.point_birth, (std::vector<int>{2, 3}));
  EXPECT_LT((third.points.row(1) - Eigen::RowVector3d(0.07, 0.05, 0)).norm(), 1e-12);
  EXPECT_EQ(second.fold_id.size(), 11u);
  EXPECT_EQ(third.fold_id.size(), 22u);
  EXPECT_EQ(std::count(third.fold_birth.begin(), third.fold_birth.end(), 2), 11);
  EXPECT_EQ(third.angle.cwiseAbs().maxCoeff(), 0) << "of the flat mesh";
}

TEST_F(SheetGuidesTest, OfFoldsNearerThanTheWidthOfARidgeTheSharpestIsKept) {
  const double width = ridge_width(shot_.paper, 0.1);
  ASSERT_GT(width, 0.001);
  for (const auto& [number, place, angle] :
       {std::tuple(1, 0.05, 1.0), std::tuple(2, 0.05 + 0.5 * width, 1.4),
        std::tuple(3, 0.05 + 0.8 * width, 1.2)}) {
    const Sheet sheet = test::folded_sheet(0.1, 0.1, place, place, angle);
    guides_.add(frame_of(sheet, number));
  }
  const CacheFrame mesh =
      mesh_of(test::folded_sheet(0.1, 0.1, 0.05 + 0.5 * width, 0.05 + 0.5 * width, 1.4));
  const CacheGuides found = guides_.at(3, mesh);
  ASSERT_EQ(found.fold_id.size(), 11u);
  for (const int birth : found.fold_birth) EXPECT_EQ(birth, 1) << "the first of them";
  for (const double angle : found.angle) EXPECT_NEAR(angle, 1.4, 1e-9);
}

}  // namespace
}  // namespace paperbake
