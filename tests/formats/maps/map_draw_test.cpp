// The layers of maps of sheets with known shapes.

#include "formats/maps/map_draw.h"

#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "tests/formats/maps/crease_map_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

using test::flat_sheet;
using test::folded_sheet;
using test::Image;
using test::of_size;
using test::rectangle;
using test::written;

/// Uniform curvature tensors: k2 along the direction at `angle`, k1 across it.
Points3 bent(const Sheet& sheet, double k1, double k2, double angle) {
  const Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
  const Eigen::Matrix2d S = k1 * across * across.transpose() + k2 * along * along.transpose();
  Points3 tensors(sheet.pattern.rows(), 3);
  for (int v = 0; v < tensors.rows(); ++v) tensors.row(v) << S(0, 0), S(0, 1), S(1, 1);
  return tensors;
}

MapTexel texel_of(const Sheet& sheet, const Points3& curvature) {
  CreaseMap map(rectangle(0.1, 0.1), of_size(32));
  map.record(1, sheet, curvature);
  return written(map).at(13, 17);
}

TEST(MapDraw, DirectionsRunAlongTheRulings) {
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  for (const double k1 : {60.0, -60.0})
    for (const double angle : {-1.5, -0.7, 0.0, 0.3, 1.2}) {
      const MapTexel t = texel_of(sheet, bent(sheet, k1, -0.2 * k1, angle));
      const double rounding = 1.01 / 512;
      EXPECT_NEAR(t.dir_x, std::cos(angle), rounding) << k1 << ", " << angle;
      EXPECT_NEAR(t.dir_y, std::sin(angle), rounding) << k1 << ", " << angle;
    }
}

TEST(MapDraw, BIsSetWherePaperBendsInOneDirectionAndFlatPaperHasNoRuling) {
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  EXPECT_EQ(texel_of(sheet, bent(sheet, 3.1, 0, 0.4)).b, 1);  // 0.31 rad over 0.1 m
  EXPECT_NEAR(texel_of(sheet, bent(sheet, 2.4, 0, 0.4)).b, 0.5, 1e-3);
  EXPECT_NEAR(texel_of(sheet, bent(sheet, 60, 36, 0.4)).b, 0.5, 1e-3);
  EXPECT_EQ(texel_of(sheet, bent(sheet, 60, -45, 0.4)).b, 0);  // crumpled
  const MapTexel flat = texel_of(sheet, bent(sheet, 1.7, 0, 0.4));
  EXPECT_EQ(flat.b, 0);
  EXPECT_EQ(flat.dir_x, 0);
  EXPECT_EQ(flat.dir_y, 0);
  EXPECT_EQ(texel_of(sheet, bent(sheet, 60, 60, 0.4)).dir_x, 0);  // a ball has no ruling
}

TEST(MapDraw, StrainsArePrincipalStretchesInPercent) {
  Sheet sheet = flat_sheet(0.1, 0.1, 0.02);
  // 2 % longer in the direction at 30 degrees, 3 % shorter across, then rotated
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const Vector2d a(std::cos(M_PI / 6), std::sin(M_PI / 6)), b(-a.y(), a.x()),
        p = sheet.pattern.row(v);
    sheet.x.row(v) << 1.02 * a.dot(p), 0.6 * 0.97 * b.dot(p), 0.8 * 0.97 * b.dot(p);
  }
  const MapTexel t = texel_of(sheet, Points3::Zero(sheet.pattern.rows(), 3));
  const double rounding = 1.0 / 256;
  EXPECT_NEAR(t.strain_max, 2, rounding);
  EXPECT_NEAR(t.strain_min, -3, rounding);
}

TEST(MapDraw, ApexConeIsTheTurnOfTheSheetAroundTheApex) {
  Sheet sheet = folded_sheet(0.1, 0.1, 0.05, 0.05, 0.8);
  sheet.singular = {{sheet.pattern.row(5 * 6 + 2), 1, "on the fold"},
                    {sheet.pattern.row(5 * 6 + 1), 1, "beside it"}};
  const std::vector<MapApex> apices = map_apices(sheet);
  EXPECT_NEAR(apices[0].turn, 2 * 0.8, 1e-9);  // two edges of the fold meet there
  EXPECT_NEAR(apices[1].turn, 0, 1e-9);
  CreaseMap map(rectangle(0.1, 0.1), of_size(64));
  map.record(1, sheet, vertex_curvature(sheet));
  const Image image = written(map);
  for (const MapTexel& t : image.texels)
    EXPECT_NEAR(t.apex_cone, t.apex_id == 1 ? 1.6 : 0, 1.0 / 1024);
}

TEST(MapDraw, CoverageIsTheAreaOfThePattern) {
  Pattern octagon;
  for (int k = 0; k < 8; ++k)
    octagon.outline.push_back(Vector2d(0.05, 0.05) +
                              0.05 * Vector2d(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4)));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.02);
  for (const int size : {100, 512}) {
    CreaseMap map(octagon, of_size(size));
    map.record(1, sheet, Points3::Zero(sheet.pattern.rows(), 3));
    double sum = 0;
    for (const MapTexel& t : written(map).texels) sum += t.a;
    EXPECT_NEAR(sum * std::pow(0.1 / size, 2) / area(octagon), 1, 1e-3);
  }
}

TEST(MapDraw, ACreaseContinuesInThePaddingAndItsAgeReachesBeyondIt) {
  CreaseMap map(rectangle(0.1, 0.05), of_size(100));  // the lower half of the map
  const Sheet sheet = folded_sheet(0.1, 0.05, 0.04, 0.06, 1.2);
  map.record(1, sheet, vertex_curvature(sheet));
  const Image image = written(map);
  for (int j = 46; j < 100; ++j) {
    const double v = (100 - j - 0.5) / 50;
    EXPECT_GT(image.at(std::lround(40 + 20 * v - 0.5), j).r, 0.4f) << j;
  }
  int lit = 0;
  for (int j = 1; j < 99; ++j)
    for (int i = 1; i < 99; ++i) {
      if (!(image.at(i, j).r > 0) || !(image.at(i, j).a > 0)) continue;
      ++lit;
      for (const auto& [x, y] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}})
        EXPECT_GE(image.at(i + x, j + y).age_crease, 0) << i << ", " << j;
    }
  EXPECT_GT(lit, 100);
}

}  // namespace
}  // namespace paperbake
