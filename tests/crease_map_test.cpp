// What the texels of a crease map say of the sheet. See crease_map_file_test.cpp for the file around them.

#include "formats/crease_map.h"

#include "core/curvature.h"
#include "core/error.h"
#include "tests/crease_map_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

using test::angle_step;
using test::flat_sheet;
using test::fold_width;
using test::Image;
using test::rectangle;
using test::rolled;
using test::tensors;
using test::written;

TEST(CreaseMap, ACylinderTurnsByTheFoldWidthOverItsRadius) {
  for (const double radius : {0.05, -0.05}) {
    CreaseMap map(rectangle(0.1, 0.1), 128, fold_width);
    const Sheet sheet = rolled(flat_sheet(0.1, 0.1, 0.002), 1 / radius);
    map.record(sheet, vertex_curvature(sheet));
    const Image image = written(map);
    // 8 texels = 3 edges inside the border, where the one-rings are whole; 3 % is what the certificate of the maps promises
    for (int j = 8; j < 120; ++j)
      for (int i = 8; i < 120; ++i) ASSERT_NEAR(image.at(image.angle, i, j), fold_width / radius, 0.03 * fold_width / std::abs(radius));
  }
}

TEST(CreaseMap, AFoldNearTheTopOfThePatternIsNearTheTopRows) {
  CreaseMap map(rectangle(0.1, 0.1), 100, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.005);
  map.record(sheet, tensors(sheet, [](Vector2d p) { return std::abs(p.y() - 0.09) < 1e-6 ? 100.0 : 0.0; }));
  const Image image = written(map);
  // v = 0.9 lies on the line between rows 9 and 10; the fold falls to nothing one edge = 5 rows away
  EXPECT_NEAR(image.at(image.angle, 50, 9), 100 * fold_width * 0.9, 2 * angle_step);
  EXPECT_NEAR(image.at(image.angle, 50, 10), 100 * fold_width * 0.9, 2 * angle_step);
  EXPECT_EQ(image.at(image.angle, 50, 3), 0);
  EXPECT_EQ(image.at(image.angle, 50, 90), 0);
}

TEST(CreaseMap, ATexelIsTheInterpolatedTensorAtItsCentre) {
  CreaseMap map(rectangle(0.1, 0.1), 64, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 20 + 300 * p.x() + 700 * p.y(); }));  // linear: interpolated exactly
  const Image image = written(map);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const double x = 0.1 * (i + 0.5) / 64, y = 0.1 * (1 - (j + 0.5) / 64);
      ASSERT_NEAR(image.at(image.angle, i, j), (20 + 300 * x + 700 * y) * fold_width, angle_step) << i << ", " << j;
    }
}

TEST(CreaseMap, TheEigenvalueIsTakenAfterInterpolatingTheTensor) {
  // x-bend at one end, y-bend of the same size at the other: half-way the tensor is k/2 in every direction, not k
  Sheet sheet = flat_sheet(0.1, 0.1, 0.1);
  Points3 S = Points3::Zero(4, 3);
  for (int v = 0; v < 4; ++v) (sheet.pattern(v, 0) > 0.05 ? S(v, 2) : S(v, 0)) = 80;
  CreaseMap map(rectangle(0.1, 0.1), 65, fold_width);  // odd: texel 32 has its centre at u = 1/2
  map.record(sheet, S);
  const Image image = written(map);
  EXPECT_NEAR(image.at(image.angle, 32, 10), 40 * fold_width, angle_step);
  EXPECT_NEAR(image.at(image.angle, 0, 10), 80 * fold_width, 0.01 * 80 * fold_width);
}

TEST(CreaseMap, ThePeakKeepsAnEarlierFoldWithItsSignWhenTheSheetFlattens) {
  CreaseMap map(rectangle(0.1, 0.1), 512, fold_width);  // finer than the memory: interpolated
  const Sheet coarse = flat_sheet(0.1, 0.1, 0.02), fine = flat_sheet(0.1, 0.1, 0.004);  // the sheet is meshed anew
  const auto left_hollow = [](double size) { return [size](Vector2d p) { return p.x() < 0.05 ? -size : size / 2; }; };
  map.record(fine, tensors(fine, left_hollow(150)));
  map.record(coarse, tensors(coarse, left_hollow(-10)));  // now bulges a little on the left
  const Image image = written(map);
  EXPECT_NEAR(image.at(image.angle, 100, 256), 10 * fold_width, angle_step);
  EXPECT_NEAR(image.at(image.peak, 100, 256), -150 * fold_width, 2 * angle_step);
  EXPECT_NEAR(image.at(image.peak, 400, 256), 75 * fold_width, 2 * angle_step);
}

TEST(CreaseMap, ThePeakIsNowhereSmallerThanTheAngle) {
  CreaseMap map(rectangle(0.1, 0.1), 512, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.002);
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 40 * std::sin(900 * p.x()); }));
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 60 * std::sin(1100 * p.x() + 400 * p.y()); }));
  const Image image = written(map);
  int larger = 0;
  for (int t = 0; t < 512 * 512; ++t) {
    ASSERT_GE(std::abs(image.peak[t]), std::abs(image.angle[t])) << t;
    larger += std::abs(image.peak[t]) > std::abs(image.angle[t]) + 0.01;
  }
  EXPECT_GT(larger, 512 * 512 / 10);  // and the first frame is not forgotten
}

TEST(CreaseMap, ThePeakDoesNotVanishWhereItsSignFlips) {
  CreaseMap map(rectangle(0.1, 0.1), 1024, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  // |peak| = 100 1/m on both sides of u = 1/2, by two frames
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 100 - 1000 * std::max(0.0, p.x() - 0.05); }));
  map.record(sheet, tensors(sheet, [](Vector2d p) { return -(100.1 - 1000 * std::max(0.0, 0.05 - p.x())); }));
  map.record(sheet, tensors(sheet, [](Vector2d) { return 0.0; }));
  const Image image = written(map);
  for (int i = 0; i < 1024; ++i) ASSERT_GT(std::abs(image.at(image.peak, i, 512)), 95 * fold_width) << i;
  EXPECT_GT(image.at(image.peak, 100, 512), 0);
  EXPECT_LT(image.at(image.peak, 900, 512), 0);
}

TEST(CreaseMap, ApexDistanceIsTheDistanceToTheNearestSingularPoint) {
  CreaseMap map(rectangle(0.1, 0.1), 200, fold_width);
  Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  sheet.singular = {{Vector2d(0.02, 0.09), 3, "a"}, {Vector2d(0.075, 0.0312), 5, "b"}, {Vector2d(0.08, 0.04), 5, "c"}};
  map.record(sheet, vertex_curvature(sheet));
  const Image image = written(map);
  for (int j = 0; j < 200; ++j)
    for (int i = 0; i < 200; ++i) {
      const Vector2d p(0.1 * (i + 0.5) / 200, 0.1 * (1 - (j + 0.5) / 200));
      double nearest = 1;
      for (const SingularPoint& s : sheet.singular) nearest = std::min(nearest, (s.pattern - p).norm());
      ASSERT_NEAR(image.at(image.distance, i, j), nearest, 0.1 / 200 / 8);  // rounded to at most an eighth of a texel
    }
}

TEST(CreaseMap, WithoutAnApexTheDistanceIsTheDiagonal) {
  CreaseMap map(rectangle(0.04, 0.03), 32, fold_width);
  const Sheet sheet = flat_sheet(0.04, 0.03, 0.01);
  map.record(sheet, vertex_curvature(sheet));
  for (const float d : written(map).distance) ASSERT_FLOAT_EQ(d, 0.05f);
}

TEST(CreaseMap, NoTexelInsideIsLeftOutOnAMeshOfSlivers) {
  // every triangle has a corner in one point off the centre, so the pattern is covered by 400 slivers
  const int rim = 400;
  const Vector2d centre(0.0312, 0.0577);
  Sheet sheet;
  sheet.pattern.resize(rim + 1, 2);
  sheet.triangles.resize(rim, 3);
  for (int k = 0; k < rim; ++k) {
    const double s = 4.0 * k / rim, f = 0.1 * (s - std::floor(s));
    const Vector2d corners[4] = {{f, 0}, {0.1, f}, {0.1 - f, 0.1}, {0, 0.1 - f}};
    sheet.pattern.row(k) = corners[int(s)];
    sheet.triangles.row(k) << rim, k, (k + 1) % rim;
  }
  sheet.pattern.row(rim) = centre;
  for (const int size : {100, 256, 333}) {
    CreaseMap map(rectangle(0.1, 0.1), size, fold_width);
    map.record(sheet, tensors(sheet, [](Vector2d p) { return 50 + 100 * p.x(); }));
    const Image image = written(map);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i)
        ASSERT_NEAR(image.at(image.angle, i, j), (50 + 10 * (i + 0.5) / size) * fold_width, angle_step) << size << ": " << i << ", " << j;
  }
}

TEST(CreaseMap, AMeshThatCutsTheCornersOfThePatternLeavesNoHole) {
  Pattern octagon;  // the sheet below is only the square inside it
  for (int k = 0; k < 8; ++k) octagon.outline.push_back(Vector2d(0.05, 0.05) + 0.05 * Vector2d(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4)));
  Sheet sheet;
  sheet.pattern.resize(4, 2);
  for (int k = 0; k < 4; ++k) sheet.pattern.row(k) = octagon.outline[2 * k];
  sheet.triangles.resize(2, 3);
  sheet.triangles << 0, 1, 2, 0, 2, 3;
  CreaseMap map(octagon, 128, fold_width);
  map.record(sheet, tensors(sheet, [](Vector2d) { return 70.0; }));
  const Image image = written(map);
  int covered = 0;
  for (const float a : image.angle) covered += std::abs(a - 70 * fold_width) < angle_step;
  // area of the octagon 2 sqrt(2) r^2 and a rim of 4 texels all around
  EXPECT_GE(covered, 2 * std::sqrt(2.0) * 64 * 64);
  EXPECT_LE(covered, 2 * std::sqrt(2.0) * 69 * 69);
}

TEST(CreaseMap, ANonSquareSheetIsNotStretchedAndPaddedByFourTexels) {
  CreaseMap map(rectangle(0.1, 0.05), 100, fold_width);  // wide: the lower half of the map
  Sheet sheet = flat_sheet(0.1, 0.05, 0.01);
  sheet.singular = {{Vector2d(0.05, 0.025), 1, "a"}};
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 50 + 1000 * p.y(); }));
  const Image image = written(map);
  for (int i = 0; i < 100; ++i) {
    for (int j = 50; j < 100; ++j) ASSERT_NEAR(image.at(image.angle, i, j), (50 + 100 * (1 - (j + 0.5) / 100)) * fold_width, angle_step);
    for (int j = 46; j < 50; ++j) {
      ASSERT_EQ(image.at(image.angle, i, j), image.at(image.angle, i, 50));
      ASSERT_EQ(image.at(image.peak, i, j), image.at(image.peak, i, 50));
      ASSERT_EQ(image.at(image.distance, i, j), image.at(image.distance, i, 50));
    }
    for (int j = 0; j < 46; ++j) {
      ASSERT_EQ(image.at(image.angle, i, j), 0);
      ASSERT_EQ(image.at(image.peak, i, j), 0);
      ASSERT_FLOAT_EQ(image.at(image.distance, i, j), std::hypot(0.1f, 0.05f));
    }
  }
}

TEST(CreaseMap, AHoleOfThePatternIsOutside) {
  Pattern pattern = rectangle(0.1, 0.1);
  pattern.holes = {{{0.03, 0.03}, {0.03, 0.07}, {0.07, 0.07}, {0.07, 0.03}}};
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);  // as a mesh with the hole, for the texels outside the hole
  CreaseMap map(pattern, 100, fold_width);
  map.record(sheet, tensors(sheet, [](Vector2d) { return 90.0; }));
  const Image image = written(map);
  EXPECT_EQ(image.at(image.angle, 50, 50), 0);
  EXPECT_EQ(image.at(image.angle, 34, 50), 0);       // 5 texels into the hole
  EXPECT_GT(image.at(image.angle, 33, 50), 0.17f);   // 4 texels: padding
  EXPECT_GT(image.at(image.angle, 29, 50), 0.17f);
}

TEST(CreaseMap, ACurvatureThatIsNotANumberIsRefused) {
  CreaseMap map(rectangle(0.1, 0.1), 16, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  Points3 S = tensors(sheet, [](Vector2d) { return 1.0; });
  S(4, 1) = std::nan("");
  EXPECT_THROW(map.record(sheet, S), Error);
}

}  // namespace
}  // namespace paperbake
