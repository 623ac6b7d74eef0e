#include "core/geometry/odt_smoothing.h"

#include "core/model/segment2.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace paperbake {
namespace {

/// A fan of triangles around its last point, which the points of a closed polygon surround.
struct Fan {
  std::vector<Vector2d> points;
  Triangles triangles;
  int rim() const { return static_cast<int>(points.size()) - 1; }
};

/// Corners at distances of 1 + up to `jitter`, and a middle as far from 0. [1]
Fan fan(int corners, double jitter, const Vector2d& middle, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  Fan fan;
  fan.triangles.resize(corners, 3);
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * M_PI * (k + uniform(random)) / corners, far = 1 + uniform(random);
    fan.points.push_back(far * Vector2d(std::cos(angle), std::sin(angle)));
    fan.triangles.row(k) << k, (k + 1) % corners, corners;
  }
  fan.points.push_back(middle);
  return fan;
}

/// What optimal-Delaunay smoothing minimises: the volume between the paraboloid |x|^2 and the
/// surface of triangles whose corners are on it [Chen 2004], of one triangle
///
///   area (|a|^2 + |b|^2 + |c|^2)/3 - integral |x|^2 = area (|ab|^2 + |bc|^2 + |ca|^2)/12
double paraboloid_error(const Fan& fan) {
  double sum = 0;
  for (int t = 0; t < fan.triangles.rows(); ++t) {
    const Vector2d &a = fan.points[fan.triangles(t, 0)], &b = fan.points[fan.triangles(t, 1)],
                   &c = fan.points[fan.triangles(t, 2)];
    sum += signed_area(a, b, c) *
           ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) / 12;
  }
  return sum;
}

/// Its slope in the place of the middle, by central differences.
Vector2d slope_at_the_middle(Fan fan) {
  constexpr double step = 1e-4;
  Vector2d slope;
  for (int i = 0; i < 2; ++i) {
    fan.points.back()[i] += step;
    const double after = paraboloid_error(fan);
    fan.points.back()[i] -= 2 * step;
    slope[i] = (after - paraboloid_error(fan)) / (2 * step);
    fan.points.back()[i] += step;
  }
  return slope;
}

TEST(OdtSmoothingTest, APointAmongNearlyEquilateralTrianglesGoesWhereTheErrorIsLeast) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Fan around = fan(6, 0.1, {0.08, -0.05}, seed);
    ASSERT_GT(slope_at_the_middle(around).norm(), 1e-2);
    smooth_points(around.triangles, around.points, around.rim());
    EXPECT_LT(slope_at_the_middle(around).norm(), 1e-9) << seed;
  }
}

TEST(OdtSmoothingTest, TheMiddleOfARegularHexagonStays) {
  Fan around = fan(6, 0, {0, 0}, 1);
  smooth_points(around.triangles, around.points, around.rim());
  EXPECT_LT(around.points.back().norm(), 1e-15);
}

TEST(OdtSmoothingTest, APointOfAnObtuseTriangleGoesToTheMeanOfTheCentroids) {
  // weighted by area, that is the centroid of all of them, here of a rectangle and a triangle
  Fan around;
  around.points = {{0, 0}, {3, 0}, {2, 2}, {0, 2}, {1.2, 0.1}};
  around.triangles.resize(4, 3);
  around.triangles << 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4;
  const Vector2d centroid = (4 * Vector2d(1, 1) + 1 * Vector2d(7 / 3.0, 2 / 3.0)) / 5;
  smooth_points(around.triangles, around.points, around.rim());
  EXPECT_LT((around.points.back() - centroid).norm(), 1e-15);
  EXPECT_GT(slope_at_the_middle(around).norm(), 0.1) << "the error is least elsewhere";
}

TEST(OdtSmoothingTest, OnlyFreePointsMoveAndAllFromWhereTheOthersWere) {
  // the last three are free; one of them is a corner of no triangle
  const std::vector<Vector2d> before{{0, 0}, {2, 0}, {4, 0},     {4, 2},     {2, 2.2},
                                     {0, 2}, {9, 9}, {1.2, 1.1}, {2.9, 0.9}, {7, 7}};
  Triangles triangles(8, 3);
  triangles << 0, 1, 7, 1, 4, 7, 4, 5, 7, 5, 0, 7, 1, 2, 8, 2, 3, 8, 3, 4, 8, 4, 1, 8;
  std::vector<Vector2d> both = before;
  smooth_points(triangles, both, 7);
  for (int k = 0; k < 7; ++k) EXPECT_EQ(both[k], before[k]) << k;
  EXPECT_EQ(both[9], before[9]) << "nothing is known of where it should be";
  for (const int k : {7, 8}) {
    EXPECT_GT((both[k] - before[k]).norm(), 1e-2);
    const Triangles own = triangles.middleRows(k == 7 ? 0 : 4, 4);
    std::vector<Vector2d> alone = before;
    smooth_points(own, alone, 7);
    EXPECT_EQ(both[k], alone[k]);
  }
}

TEST(OdtSmoothingTest, WhateverTheTrianglesAPointStaysWithinTheirHull) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  int thin = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const double right = uniform(random), up = uniform(random);
    Fan around = fan(4 + static_cast<int>(seed % 5), 0.45, {right, up}, seed);
    const std::vector<Vector2d> rim(around.points.begin(), around.points.end() - 1);
    const auto is_turned_over = [&](const Eigen::RowVector3i& t) {
      return signed_area(around.points[t[0]], around.points[t[1]], around.points[t[2]]) <= 0;
    };
    bool is_mesh = true;
    for (const auto& t : around.triangles.rowwise()) is_mesh &= !is_turned_over(t);
    if (!is_mesh) continue;
    smooth_points(around.triangles, around.points, around.rim());
    thin += slope_at_the_middle(around).norm() > 1e-3;
    for (int k = 0; k < 90; ++k) {
      const Vector2d outwards(std::cos(M_PI * k / 45), std::sin(M_PI * k / 45));
      double farthest = -10;
      for (const Vector2d& corner : rim) farthest = std::max(farthest, outwards.dot(corner));
      ASSERT_LE(outwards.dot(around.points.back()), farthest) << seed;
    }
  }
  EXPECT_GT(thin, 300);
}

}  // namespace
}  // namespace paperbake
