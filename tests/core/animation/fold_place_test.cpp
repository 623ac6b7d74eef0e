#include "core/animation/fold_place.h"

#include "core/methods/fem.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

constexpr int frames = 24;

/// A flat page of 150 x 210 mm with a row of three handles on either side of its middle, 40 mm
/// apart. In the last frame the upper row is `apart` [m] above the lower one.
Shot page_of_two_rows(double apart) {
  Shot shot = test::blank_shot(test::rectangle(0.15, 0.21));
  for (const double y : {0.085, 0.125})
    for (const double x : {0.0, 0.075, 0.15}) {
      Handle handle =
          test::bare_handle("handle." + std::to_string(shot.handles.size()), {x, y}, frames);
      if (y > 0.1) handle.keyed.row(frames - 1) << x, 0.085, apart;
      shot.handles.push_back(handle);
    }
  return shot;
}

/// [m] Where the two ends of a line across the page come to lie.
std::optional<Vector2d> moved(const Shot& shot, double left, double right, int row = 0) {
  const PatternMesh mesh = fem(120).make()->first_mesh(shot.pattern, {});
  Sheet sheet;
  sheet.pattern = mesh.vertices;
  sheet.triangles = mesh.triangles;
  sheet.x = Points3::Zero(mesh.vertices.rows(), 3);
  sheet.x.leftCols<2>() = mesh.vertices;
  sheet.v = Points3::Zero(mesh.vertices.rows(), 3);
  Elastic elastic(shot.paper, {});
  PlasticGrid grid(shot.pattern);
  const std::optional<FoldLine> line =
      flat_place({{0, left}, {0.15, right}, 0, {}},
                 {shot, sheet, elastic, grid, 1, {{}, 1 / 24.0, 0, row, 0}, {}});
  if (!line) return std::nullopt;
  const bool turned = line->a.x() > line->b.x();
  return Vector2d(turned ? line->b.y() : line->a.y(), turned ? line->a.y() : line->b.y());
}

TEST(FoldPlaceTest, AFoldMovesHalfWayBetweenRowsOfHandlesThatMeet) {
  const Shot shot = page_of_two_rows(0.002);
  for (const double left : {0.095, 0.1, 0.112})
    for (const double right : {0.097, 0.108}) {
      SCOPED_TRACE(std::to_string(left) + " " + std::to_string(right));
      const std::optional<Vector2d> place = moved(shot, left, right);
      ASSERT_TRUE(place);
      EXPECT_NEAR((*place)[0], 0.105, 5e-4);
      EXPECT_NEAR((*place)[1], 0.105, 5e-4);
    }
}

TEST(FoldPlaceTest, AFoldStaysWhereBothSidesCanBeFlat) {
  EXPECT_FALSE(moved(page_of_two_rows(0.002), 0.105, 0.105));
  EXPECT_FALSE(moved(page_of_two_rows(0.03), 0.1, 0.1));
}

TEST(FoldPlaceTest, AFoldFarFromWhereBothSidesCanBeFlatStays) {
  EXPECT_FALSE(moved(page_of_two_rows(0.002), 0.16, 0.16));
}

}  // namespace
}  // namespace paperbake
