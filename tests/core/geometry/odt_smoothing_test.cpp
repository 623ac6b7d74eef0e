#include "core/geometry/odt_smoothing.h"

#include "core/model/segment2.h"

#include <gtest/gtest.h>

#include <random>

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
  // the mean of the centroids, weighted by area, is the centroid of the square
  Fan around;
  around.points = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0.2, -0.9}};
  around.triangles.resize(4, 3);
  around.triangles << 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4;
  smooth_points(around.triangles, around.points, 4);
  EXPECT_LT(around.points[4].norm(), 1e-15);
}

TEST(OdtSmoothingTest, OnlyFreePointsMoveAndAllFromWhereTheOthersWere) {
  // the last three are free; one of them is a corner of no triangle
  const std::vector<Vector2d> before{{0, 0}, {2, 0}, {4, 0},     {4, 2},     {2, 2.2},
                                     {0, 2}, {9, 9}, {1.2, 1.1}, {2.9, 0.9}, {7, 7}};
  Triangles triangles(10, 3);
  triangles << 0, 1, 7, 1, 4, 7, 4, 5, 7, 5, 0, 7, 1, 2, 8, 2, 3, 8, 3, 4, 8, 4, 1, 8, 0, 0, 0, 6,
      6, 6;
  triangles.conservativeResize(8, 3);
  std::vector<Vector2d> both = before;
  smooth_points(triangles, both, 7);
  for (int k = 0; k < 7; ++k) EXPECT_EQ(both[k], before[k]) << k;
  EXPECT_EQ(both[9], before[9]) << "nothing is known of where it should be";
  for (const int k : {7, 8}) {
    EXPECT_GT((both[k] - before[k]).norm(), 1e-2);
    Triangles own(4, 3);
    own = triangles.middleRows(k == 7 ? 0 : 4, 4);
    std::vector<Vector2d> alone = before;
    smooth_points(own, alone, 7);
    EXPECT_EQ(both[k], alone[k]);
  }
}

/// Whether a point lies in a triangle of the fan.
bool is_in(const Fan& around, const std::vector<Vector2d>& rim, const Vector2d& p) {
  for (int k = 0; k < around.rim(); ++k)
    if (barycentric(p, rim[k], rim[(k + 1) % around.rim()], {0, 0}).minCoeff() > -1e-12) return true;
  return false;
}

TEST(OdtSmoothingTest, WhateverTheTrianglesAPointStaysAmongThem) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  int bad = 0;
  for (unsigned seed = 0; seed < 20000; ++seed) {
    Fan around = fan(4 + seed % 5, 0.45, {uniform(random), uniform(random)}, seed);
    bool valid = true;
    for (int t = 0; t < around.triangles.rows(); ++t)
      valid &= signed_area(around.points[around.triangles(t, 0)], around.points[around.triangles(t, 1)],
                           around.points.back()) > 0;
    if (!valid) continue;
    const std::vector<Vector2d> rim = around.points;
    const Vector2d old = around.points.back();
    smooth_points(around.triangles, around.points, around.rim());
    const Vector2d p = around.points.back();
    // hull
    bool in = false;
    for (int i = 0; i < around.rim() && !in; ++i)
      for (int j = 0; j < i && !in; ++j)
        for (int k = 0; k < j && !in; ++k) {
          const Vector3d b = barycentric(p, rim[i], rim[j], rim[k]);
          in = b.allFinite() && b.minCoeff() > -1e-9;
        }
    if (!in) ++bad;
    if (!in && bad < 4) { printf("seed %u corners %d old %g %g new %g %g\n", seed, around.rim(), old.x(), old.y(), p.x(), p.y()); }
  }
  printf("bad %d\n", bad);
}

}  // namespace
}  // namespace paperbake
