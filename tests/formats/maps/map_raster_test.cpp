#include "formats/maps/map_raster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace paperbake {
namespace {

double total(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// A regular polygon [texel]; direction 1: counter-clockwise on the pattern, whose v points up.
std::vector<Vector2d> round_loop(const Vector2d& centre, double radius, int corners,
                                 double direction) {
  std::vector<Vector2d> loop;
  for (int k = 0; k < corners; ++k)
    loop.push_back(centre + radius * Vector2d(std::cos(direction * 2 * M_PI * k / corners),
                                              -std::sin(direction * 2 * M_PI * k / corners)));
  return loop;
}

TEST(MapRaster, CoverageIsTheAreaOfThePolygonsWithoutTheirHoles) {
  const int n = 17;
  const std::vector<std::vector<Vector2d>> loops{round_loop({31.3, 30.8}, 29.7, n, 1),
                                                 round_loop({35, 27.2}, 8.1, n, -1)};
  const double area = 0.5 * n * std::sin(2 * M_PI / n) * (29.7 * 29.7 - 8.1 * 8.1);
  const std::vector<float> coverage = area_coverage(loops, {64, 0, 64});
  EXPECT_NEAR(total(coverage), area, 1e-3);  // texels are 32-bit floats
  int partly = 0;
  for (const float a : coverage) {
    ASSERT_GE(a, 0);
    ASSERT_LE(a, 1);
    partly += a > 0 && a < 1;
  }
  EXPECT_GT(partly, 200);  // at least one texel per texel of the two circumferences, 187 + 51
}

TEST(MapRaster, StripsOfRowsAreTheWholePicture) {
  const std::vector<std::vector<Vector2d>> loops{round_loop({31.3, 30.8}, 29.7, 5, 1)};
  const std::vector<float> whole = area_coverage(loops, {64, 0, 64});
  std::vector<float> strips;
  for (int first = 0; first < 64; first += 16)
    for (const float a : area_coverage(loops, {64, first, first + 16})) strips.push_back(a);
  ASSERT_GT(total(whole), 1000);
  EXPECT_EQ(whole, strips);
}

TEST(MapRaster, ATexelHalfInASquareIsHalfCovered) {
  // integers are centres: an edge at 1 bisects texel 1
  const std::vector<float> coverage =
      area_coverage({{{1, 1}, {1, 5.25}, {3, 5.25}, {3, 1}}}, {8, 0, 8});
  EXPECT_FLOAT_EQ(coverage[2 * 8 + 1], 0.5f);
  EXPECT_FLOAT_EQ(coverage[2 * 8 + 2], 1.0f);
  EXPECT_FLOAT_EQ(coverage[5 * 8 + 2], 0.75f);
  EXPECT_FLOAT_EQ(coverage[1 * 8 + 3], 0.25f);
  EXPECT_EQ(coverage[2 * 8 + 4], 0.0f);
}

TEST(MapRaster, NearASegmentAreAllTexelsWithinReachAndNoOthers) {
  const Vector2d a(5.3, 20.1), b(27.9, 9.4);
  const double reach = 3.7;
  for (const auto& [p, q] : {std::pair(a, b), std::pair(b, a),
                             std::pair(a, Vector2d(a + Vector2d(20, 0))), std::pair(a, a)}) {
    std::vector<int> hits(32 * 32, 0);
    for_each_near_segment(p, q, reach, {32, 0, 32}, [&](int i, int row, double distance, double t) {
      ++hits[row * 32 + i];
      EXPECT_NEAR((p + t * (q - p) - Vector2d(i, row)).norm(), distance, 1e-12);
    });
    int found = 0;
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) {
        double nearest = 1e9;
        for (int k = 0; k <= 2000; ++k)
          nearest = std::min(nearest, (p + k / 2000.0 * (q - p) - Vector2d(i, j)).norm());
        if (std::abs(nearest - reach) < 0.01) continue;  // too close for the sampled distance
        ASSERT_EQ(hits[j * 32 + i], nearest < reach) << i << ", " << j;
        found += hits[j * 32 + i];
      }
    EXPECT_GT(found, 35);  // pi 3.7^2 = 43
  }
}

TEST(MapRaster, NearPointsHoldTheNearestOfEveryTexelOfTheBlock) {
  std::vector<Vector2d> points;
  for (int k = 0; k < 40; ++k) points.push_back({std::fmod(17.3 * k, 64), std::fmod(29.1 * k, 61)});
  const std::vector<int> near = near_points(points, {23.5, 39.5}, 8 * std::sqrt(2.0));
  EXPECT_LT(near.size(), 40u);
  for (int j = 32; j < 48; ++j)
    for (int i = 16; i < 32; ++i) {
      int nearest = 0;
      for (int k = 1; k < 40; ++k)
        if ((points[k] - Vector2d(i, j)).norm() < (points[nearest] - Vector2d(i, j)).norm())
          nearest = k;
      EXPECT_NE(std::find(near.begin(), near.end(), nearest), near.end());
    }
}

}  // namespace
}  // namespace paperbake
