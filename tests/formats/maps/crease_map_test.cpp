// The texels of crease maps of sheets with known shapes. The file is tested in map_file_test.cpp.

#include "formats/maps/crease_map.h"

#include "core/geometry/curvature.h"
#include "core/model/error.h"
#include "tests/formats/maps/crease_map_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

using test::angle_step;
using test::flat_sheet;
using test::fold_width;
using test::folded_sheet;
using test::Image;
using test::of_size;
using test::rectangle;
using test::rolled;
using test::tensors;
using test::written;

TEST(CreaseMap, ACylinderTurnsByTheFoldWidthOverItsRadius) {
  for (const double radius : {0.05, -0.05}) {
    CreaseMap map(rectangle(0.1, 0.1), of_size(128));
    const Sheet sheet = rolled(flat_sheet(0.1, 0.1, 0.002), 1 / radius);
    map.record(1, sheet, vertex_curvature(sheet));
    const Image image = written(map);
    // at least 8 texels = 3 edges from the border, where the one-rings are complete; 3 % is the
    // accuracy that the maps promise
    for (int j = 8; j < 120; ++j)
      for (int i = 8; i < 120; ++i)
        ASSERT_NEAR(image.at(i, j).fold_angle, fold_width / radius,
                    0.03 * fold_width / std::abs(radius));
  }
}

TEST(CreaseMap, AFacetBetweenTwoCreasesIsFlatHoweverLargeItIs) {
  // every vertex of the middle facets lies on a crease
  CreaseMap map(rectangle(0.12, 0.12), of_size(120));
  Sheet sheet = flat_sheet(0.12, 0.12, 0.04);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0);
    sheet.x(v, 0) = std::clamp(s, 0.04, 0.08);
    sheet.x(v, 2) = std::min(s, 0.04) + 0.04 - std::max(s, 0.08);
  }
  map.record(1, sheet, vertex_curvature(sheet), 0.25 * vertex_curvature(sheet));
  const Image image = written(map);
  for (int j = 5; j < 115; ++j) {
    for (const int i : {39, 40, 79, 80}) {
      ASSERT_NEAR(image.at(i, j).fold_angle, M_PI / 2, angle_step) << i << ' ' << j;
      ASSERT_NEAR(image.at(i, j).fold_plastic, M_PI / 8, angle_step) << i << ' ' << j;
      ASSERT_NEAR(image.at(i, j).fold_peak, M_PI / 2, angle_step) << i << ' ' << j;
    }
    // core/geometry/curvature leaves a little of a crease beyond its one-rings
    for (const int i : {5, 30, 50, 60, 70, 90, 115})
      ASSERT_NEAR(image.at(i, j).fold_angle, 0, 0.04 * M_PI / 2) << i << ' ' << j;
  }
}

TEST(CreaseMap, AFoldNearTheTopOfThePatternIsNearTheTopRows) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(100));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.005);
  map.record(1, sheet, tensors(sheet, [](Vector2d p) {
               return std::abs(p.y() - 0.09) < 1e-6 ? 100.0 : 0.0;
             }));
  const Image image = written(map);
  // v = 0.9 is the line between rows 9 and 10; the fold falls to 0 over one edge = 5 rows
  EXPECT_NEAR(image.at(50, 9).fold_angle, 100 * fold_width * 0.9, 2 * angle_step);
  EXPECT_NEAR(image.at(50, 10).fold_angle, 100 * fold_width * 0.9, 2 * angle_step);
  EXPECT_EQ(image.at(50, 3).fold_angle, 0);
  EXPECT_EQ(image.at(50, 90).fold_angle, 0);
}

TEST(CreaseMap, ATexelIsTheInterpolatedTensorAtItsCentre) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(64));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  // linear: interpolated exactly
  map.record(1, sheet, tensors(sheet, [](Vector2d p) { return 20 + 300 * p.x() + 700 * p.y(); }));
  const Image image = written(map);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const double x = 0.1 * (i + 0.5) / 64, y = 0.1 * (1 - (j + 0.5) / 64);
      ASSERT_NEAR(image.at(i, j).fold_angle, (20 + 300 * x + 700 * y) * fold_width, angle_step)
          << i << ", " << j;
    }
}

TEST(CreaseMap, TheEigenvalueIsTakenAfterInterpolatingTheTensor) {
  // bent along x at one end and along y at the other: half-way the tensor is k/2 in every
  // direction, and its eigenvalue is not k
  Sheet sheet = flat_sheet(0.1, 0.1, 0.1);
  Points3 S = Points3::Zero(4, 3);
  for (int v = 0; v < 4; ++v) (sheet.pattern(v, 0) > 0.05 ? S(v, 2) : S(v, 0)) = 80;
  CreaseMap map(rectangle(0.1, 0.1), of_size(65));  // odd: texel 32 has its centre at u = 1/2
  map.record(1, sheet, S);
  const Image image = written(map);
  EXPECT_NEAR(image.at(32, 10).fold_angle, 40 * fold_width, angle_step);
  EXPECT_NEAR(image.at(0, 10).fold_angle, 80 * fold_width, 0.01 * 80 * fold_width + angle_step / 2);
}

TEST(CreaseMap, ThePeakKeepsAnEarlierFoldWithItsSignWhenTheSheetFlattens) {
  CreaseMap map(rectangle(0.1, 0.1),
                of_size(1024));  // finer than the grid of the peak, so interpolated
  // the sheet is remeshed
  const Sheet coarse = flat_sheet(0.1, 0.1, 0.02), fine = flat_sheet(0.1, 0.1, 0.004);
  const auto left_hollow = [](double size) {
    return [size](Vector2d p) { return p.x() < 0.05 ? -size : size / 2; };
  };
  map.record(1, fine, tensors(fine, left_hollow(150)));
  map.record(1, coarse, tensors(coarse, left_hollow(-10)));  // now the left bulges a little
  const Image image = written(map);
  EXPECT_NEAR(image.at(200, 512).fold_angle, 10 * fold_width, angle_step);
  EXPECT_NEAR(image.at(200, 512).fold_peak, -150 * fold_width, 2 * angle_step);
  EXPECT_NEAR(image.at(800, 512).fold_peak, 75 * fold_width, 2 * angle_step);
}

TEST(CreaseMap, ThePeakIsNowhereSmallerThanTheAngle) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(512));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.002);
  map.record(1, sheet, tensors(sheet, [](Vector2d p) { return 40 * std::sin(900 * p.x()); }));
  map.record(1, sheet,
             tensors(sheet, [](Vector2d p) { return 60 * std::sin(1100 * p.x() + 400 * p.y()); }));
  const Image image = written(map);
  int larger = 0;
  for (int t = 0; t < 512 * 512; ++t) {
    ASSERT_GE(std::abs(image.texels[t].fold_peak), std::abs(image.texels[t].fold_angle)) << t;
    larger += std::abs(image.texels[t].fold_peak) > std::abs(image.texels[t].fold_angle) + 0.01;
  }
  EXPECT_GT(larger, 512 * 512 / 10);  // where the first frame had the peak
}

TEST(CreaseMap, ThePeakDoesNotVanishWhereItsSignFlips) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(1024));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  // two frames give |peak| = 100 1/m on both sides of u = 1/2, with opposite signs
  map.record(1, sheet,
             tensors(sheet, [](Vector2d p) { return 100 - 1000 * std::max(0.0, p.x() - 0.05); }));
  map.record(1, sheet, tensors(sheet, [](Vector2d p) {
               return -(100.1 - 1000 * std::max(0.0, 0.05 - p.x()));
             }));
  map.record(1, sheet, tensors(sheet, [](Vector2d) { return 0.0; }));
  const Image image = written(map);
  for (int i = 0; i < 1024; ++i)
    ASSERT_GT(std::abs(image.at(i, 512).fold_peak), 95 * fold_width) << i;
  EXPECT_GT(image.at(100, 512).fold_peak, 0);
  EXPECT_LT(image.at(900, 512).fold_peak, 0);
}

TEST(CreaseMap, ApexDistanceIsTheDistanceToTheNearestSingularPoint) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(200));
  Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  sheet.singular = {{Vector2d(0.02, 0.09), 3, "a"},
                    {Vector2d(0.075, 0.0312), 5, "b"},
                    {Vector2d(0.08, 0.04), 5, "c"}};
  map.record(1, sheet, vertex_curvature(sheet));
  const Image image = written(map);
  for (int j = 0; j < 200; ++j)
    for (int i = 0; i < 200; ++i) {
      const Vector2d p(0.1 * (i + 0.5) / 200, 0.1 * (1 - (j + 0.5) / 200));
      double nearest = 1;
      for (const SingularPoint& s : sheet.singular)
        nearest = std::min(nearest, (s.pattern - p).norm());
      // rounded to steps of at most half a texel
      ASSERT_NEAR(image.at(i, j).apex_dist, nearest, 0.1 / 200 / 4);
    }
}

TEST(CreaseMap, WithoutAnApexTheDistanceIsTheDiagonal) {
  CreaseMap map(rectangle(0.04, 0.03), of_size(32));
  const Sheet sheet = flat_sheet(0.04, 0.03, 0.01);
  map.record(1, sheet, vertex_curvature(sheet));
  for (const MapTexel& texel : written(map).texels) ASSERT_EQ(texel.apex_dist, half(0.05f));
}

TEST(CreaseMap, NoTexelInsideIsLeftOutOnAMeshOfSlivers) {
  // all triangles share a vertex off the centre, so the pattern is covered by 400 slivers
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
  sheet.x = Points3::Zero(rim + 1, 3);
  sheet.x.leftCols<2>() = sheet.pattern;
  for (const int size : {100, 256, 333}) {
    CreaseMap map(rectangle(0.1, 0.1), of_size(size));
    map.record(1, sheet, tensors(sheet, [](Vector2d p) { return 50 + 100 * p.x(); }));
    const Image image = written(map);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i)
        ASSERT_NEAR(image.at(i, j).fold_angle, (50 + 10 * (i + 0.5) / size) * fold_width,
                    angle_step)
            << size << ": " << i << ", " << j;
  }
}

TEST(CreaseMap, AMeshThatCutsTheCornersOfThePatternLeavesNoHole) {
  Pattern octagon;  // the mesh covers only the inscribed square
  for (int k = 0; k < 8; ++k)
    octagon.outline.push_back(Vector2d(0.05, 0.05) +
                              0.05 * Vector2d(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4)));
  Sheet sheet;
  sheet.pattern.resize(4, 2);
  for (int k = 0; k < 4; ++k) sheet.pattern.row(k) = octagon.outline[2 * k];
  sheet.triangles.resize(2, 3);
  sheet.triangles << 0, 1, 2, 0, 2, 3;
  sheet.x = Points3::Zero(4, 3);
  sheet.x.leftCols<2>() = sheet.pattern;
  CreaseMap map(octagon, of_size(128));
  map.record(1, sheet, tensors(sheet, [](Vector2d) { return 70.0; }));
  const Image image = written(map);
  int covered = 0;
  for (const MapTexel& texel : image.texels)
    covered += std::abs(texel.fold_angle - 70 * fold_width) < angle_step;
  // area of the octagon, 2 sqrt(2) r^2, and at most a rim of 4 texels around it
  EXPECT_GE(covered, 2 * std::sqrt(2.0) * 64 * 64);
  EXPECT_LE(covered, 2 * std::sqrt(2.0) * 69 * 69);
}

TEST(CreaseMap, ANonSquareSheetIsNotStretchedAndPaddedByFourTexels) {
  CreaseMap map(rectangle(0.1, 0.05), of_size(100));  // covers the lower half of the map
  Sheet sheet = flat_sheet(0.1, 0.05, 0.01);
  sheet.singular = {{Vector2d(0.05, 0.025), 1, "a"}};
  map.record(1, sheet, tensors(sheet, [](Vector2d p) { return 50 + 1000 * p.y(); }));
  const Image image = written(map);
  for (int i = 0; i < 100; ++i) {
    for (int j = 50; j < 100; ++j)
      ASSERT_NEAR(image.at(i, j).fold_angle, (50 + 100 * (1 - (j + 0.5) / 100)) * fold_width,
                  angle_step);
    for (int j = 46; j < 50; ++j) {
      ASSERT_NEAR(image.at(i, j).fold_angle, 100 * fold_width,
                  angle_step);  // the value at the border
      ASSERT_NEAR(image.at(i, j).fold_peak, 100 * fold_width, angle_step);
      ASSERT_EQ(image.at(i, j).a, 0);
      ASSERT_EQ(image.at(i, j).apex_id, 1u);
    }
    for (int j = 0; j < 46; ++j) {
      ASSERT_EQ(image.at(i, j).fold_angle, 0);
      ASSERT_EQ(image.at(i, j).fold_peak, 0);
      ASSERT_EQ(image.at(i, j).apex_id, 0u);
      ASSERT_EQ(image.at(i, j).apex_dist, half(std::hypot(0.1f, 0.05f)));
    }
  }
}

TEST(CreaseMap, AHoleOfThePatternIsOutside) {
  Pattern pattern = rectangle(0.1, 0.1);
  pattern.holes = {{{0.03, 0.03}, {0.03, 0.07}, {0.07, 0.07}, {0.07, 0.03}}};
  // a mesh without the hole gives the same texels outside it
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  CreaseMap map(pattern, of_size(100));
  map.record(1, sheet, tensors(sheet, [](Vector2d) { return 90.0; }));
  const Image image = written(map);
  EXPECT_EQ(image.at(50, 50).fold_angle, 0);
  EXPECT_EQ(image.at(34, 50).fold_angle, 0);      // 5 texels into the hole
  EXPECT_GT(image.at(33, 50).fold_angle, 0.17f);  // 4 texels: padding
  EXPECT_GT(image.at(29, 50).fold_angle, 0.17f);
}

TEST(CreaseMap, ACurvatureThatIsNotANumberIsRefused) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(16));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  Points3 S = tensors(sheet, [](Vector2d) { return 1.0; });
  S(4, 1) = std::nan("");
  EXPECT_THROW(map.record(1, sheet, S), Error);
}

/// Centroid of a layer in a row between two columns. [texel]
template <class Value>
double centre_of_row(const Image& image, int j, int from, int to, const Value& value) {
  double sum = 0, moment = 0;
  for (int i = from; i < to; ++i) {
    sum += value(image.at(i, j));
    moment += i * value(image.at(i, j));
  }
  return moment / sum;
}

TEST(CreaseMap, AFoldIsFoundWithinHalfATexelOfWhereItIs) {
  const double bottom = 0.0417, top = 0.0566;  // slanted, over 76 columns of 512
  for (const int size : {512, 2048}) {
    CreaseMap map(rectangle(0.1, 0.1), of_size(size));
    const Sheet sheet = folded_sheet(0.1, 0.1, bottom, top, 1.2);
    map.record(1, sheet, vertex_curvature(sheet), {});
    const Image image = written(map);
    for (int j = size / 8; j < 7 * size / 8; ++j) {
      const double v = 1 - (j + 0.5) / size,
                   fold = (bottom + (top - bottom) * v) / 0.1 * size - 0.5;
      const int near = size / 20;
      // 1.2 / (pi/2) = 0.76, at the nearest texel
      ASSERT_GT(image.at(std::lround(fold), j).r, 0.7f) << j;
      ASSERT_NEAR(
          centre_of_row(image, j, fold - near, fold + near, [](const MapTexel& t) { return t.r; }),
          fold, 0.25)
          << j;
      // one-rings that reach the border see less of the fold
      if (j < size / 4 || j >= 3 * size / 4) continue;
      // fold.angle has the shape of a roof over the fold: the centroid of its upper tenth
      const double top_angle = image.at(std::lround(fold), j).fold_angle;
      ASSERT_GT(top_angle, 0.1) << j;
      ASSERT_NEAR(centre_of_row(image, j, fold - near, fold + near,
                                [&](const MapTexel& t) {
                                  return std::max(0.0, t.fold_angle - 0.9 * top_angle);
                                }),
                  fold, 0.5)
          << j;
    }
  }
}

TEST(CreaseMap, AnApexIsFoundWithinATexelAndIsTheOneOfItsNumber) {
  for (const int size : {512, 2048}) {
    CreaseMap map(rectangle(0.1, 0.1), of_size(size));
    Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
    sheet.singular = {{Vector2d(0.0213, 0.0907), 3, "a"},
                      {Vector2d(0.0751, 0.0312), 5, "b"},
                      {Vector2d(0.0829, 0.0412), 5, "c"}};
    map.record(5, sheet, vertex_curvature(sheet));
    const Image image = written(map);
    for (std::size_t k = 0; k < 3; ++k) {
      const double u = sheet.singular[k].pattern.x() / 0.1 * size - 0.5,
                   v = size - 0.5 - sheet.singular[k].pattern.y() / 0.1 * size;
      double mask = 0, x = 0, y = 0, nearest = 1;
      int at_i = 0, at_j = 0;
      for (int j = v - size / 30; j < v + size / 30; ++j)
        for (int i = u - size / 30; i < u + size / 30; ++i) {
          const MapTexel& t = image.at(i, j);
          mask += t.g;
          x += i * double(t.g);
          y += j * double(t.g);
          if (t.apex_dist < nearest) {
            nearest = t.apex_dist;
            at_i = i;
            at_j = j;
          }
        }
      ASSERT_GT(mask, 1);
      EXPECT_NEAR(x / mask, u, 0.25);
      EXPECT_NEAR(y / mask, v, 0.25);
      EXPECT_NEAR(at_i, u, 1);
      EXPECT_NEAR(at_j, v, 1);
      EXPECT_EQ(image.at(at_i, at_j).apex_id, k + 1);
    }
  }
}

TEST(CreaseMap, AgesAreSecondsSinceTheFirstCreaseAndTheBirth) {
  for (const double fps : {24.0, 25.0, 30000.0 / 1001}) {
    CreaseMap map(rectangle(0.1, 0.1), of_size(128));
    Sheet sheet = folded_sheet(0.1, 0.1, 0.05, 0.05, 1.2);
    map.record(1, flat_sheet(0.1, 0.1, 0.02), Points3::Zero(36, 3));
    for (int frame = 8; frame <= 20; ++frame) {
      if (frame == 14) sheet.singular = {{Vector2d(0.05, 0.05), 14, "a"}};
      map.record(frame, sheet, vertex_curvature(sheet));
    }
    const Image image = written(map, {20, fps, 0, ""});
    constexpr double of_16_bits = 1.0 / 2048;  // [1]
    EXPECT_NEAR(image.at(63, 40).age_crease, 12 / fps, of_16_bits * 12 / fps);
    EXPECT_NEAR(image.at(20, 40).age_apex, 6 / fps, of_16_bits * 6 / fps);
    EXPECT_EQ(image.at(20, 40).age_crease, -1);
    EXPECT_GT(image.at(63, 40).r, 0.3f);
  }
}

TEST(CreaseMap, ACreaseStaysWhenTheSheetIsFlatAgainAndGetsStrongerButNeverWeaker) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(256));
  float strength = 0;
  for (const double angle : {0.6, 1.2, 0.9, 0.0, 1.4}) {
    const Sheet sheet = folded_sheet(0.1, 0.1, 0.04, 0.06, angle);
    map.record(1, sheet, vertex_curvature(sheet));
    float now = 0;
    for (const MapTexel& texel : written(map).texels) now = std::max<float>(now, texel.r);
    EXPECT_GE(now, strength) << angle;
    if (angle == 0.0) {
      EXPECT_NEAR(now, 1.2 / (M_PI / 2), 0.01);
    }
    strength = now;
  }
  EXPECT_NEAR(strength, 1.4 / (M_PI / 2), 0.01);
}

TEST(CreaseMap, FoldPlasticIsTheAngleOfThePlasticCurvature) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(64));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  map.record(1, sheet, tensors(sheet, [](Vector2d) { return 150.0; }),
             tensors(sheet, [](Vector2d p) { return -40 - 300 * p.x(); }));
  const Image image = written(map);
  EXPECT_NEAR(image.at(10, 20).fold_plastic, -(40 + 30 * 10.5 / 64) * fold_width, angle_step);
  EXPECT_NEAR(image.at(10, 20).fold_angle, 150 * fold_width, angle_step);
}

}  // namespace
}  // namespace paperbake
