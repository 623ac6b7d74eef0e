#include "core/geometry/edge_operations.h"
#include "core/geometry/intersections.h"

#include "core/geometry/measure.h"
#include "core/geometry/pattern_mesh.h"
#include "core/methods/adaptive_mesh/sizing_field.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

/// The same metric everywhere, with sizes h_x and h_y. [m]
Points3 even(const Sheet& sheet, double h_x, double h_y) {
  return Eigen::RowVector3d(1 / (h_x * h_x), 0, 1 / (h_y * h_y)).replicate(sheet.pattern.rows(), 1);
}

/// Longest and shortest edge, in the metric.
std::pair<double, double> lengths(const Sheet& sheet, const Points3& metric) {
  double longest = 0, shortest = 1e9;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const double l =
          metric_length(sheet, metric, sheet.triangles(t, i), sheet.triangles(t, (i + 1) % 3));
      longest = std::max(longest, l);
      shortest = std::min(shortest, l);
    }
  return {longest, shortest};
}

void refine(Sheet& sheet, Points3& metric, int most = 100000) {
  while (split_long_edges(sheet, metric, most) > 0) flip_to_delaunay(sheet, metric);
}

TEST(EdgeOperationsTest, SplitsAndFlipsMakeEdgesShortEnoughAndNoShorterThanNeeded) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 4, 0.2);
  Points3 metric = even(sheet, 0.005, 0.02);
  refine(sheet, metric);
  test::expect_sound(sheet, 0.01);
  EXPECT_LE(lengths(sheet, metric).first, 1);
  EXPECT_LT(sheet.triangles.rows(), 1.2 * triangles_of(sheet, metric));
  EXPECT_GT(sheet.triangles.rows(), 0.8 * triangles_of(sheet, metric));
  Sheet fine = test::hex_sheet(0.1, 0.1, 4, 0.2);  // isotropic and as fine
  Points3 isotropic = even(fine, 0.005, 0.005);
  refine(fine, isotropic);
  EXPECT_LT(sheet.triangles.rows(), 0.4 * fine.triangles.rows());
}

TEST(EdgeOperationsTest, SplitsLeaveTheSurfaceAsItIs) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  test::roll(sheet, 0.05);
  sheet.v = 2 * sheet.x;
  const auto surface = [](const Sheet& s) {
    double sum = 0;
    for (int t = 0; t < s.triangles.rows(); ++t) {
      const Vector3d a = s.x.row(s.triangles(t, 0)), b = s.x.row(s.triangles(t, 1)),
                     c = s.x.row(s.triangles(t, 2));
      sum += 0.5 * (b - a).cross(c - a).norm();
    }
    return sum;
  };
  const double before = surface(sheet);
  Points3 metric = even(sheet, 0.01, 0.01);
  ASSERT_GT(split_long_edges(sheet, metric, 100000), 20);
  EXPECT_NEAR(surface(sheet), before, 1e-12);
  EXPECT_TRUE(sheet.v.isApprox(2 * sheet.x, 1e-12));
  test::expect_sound(sheet, 0.01);
}

/// |V| 1 for the first vertices.
std::vector<char> first(int count, const Sheet& sheet) {
  std::vector<char> kept(sheet.pattern.rows(), 0);
  std::fill_n(kept.begin(), count, 1);
  return kept;
}

TEST(EdgeOperationsTest, SplitsStopAtTheLargestNumberOfTriangles) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 4);
  Points3 metric = even(sheet, 0.002, 0.002);
  refine(sheet, metric, 300);
  EXPECT_LE(sheet.triangles.rows(), 300);
  EXPECT_GT(sheet.triangles.rows(), 290);
  test::expect_sound(sheet, 0.01);
}

TEST(EdgeOperationsTest, CollapsesKeepBorderHolesAndFixedVertices) {
  const Pattern pattern{{{0, 0}, {0.12, 0}, {0.12, 0.05}, {0.06, 0.08}, {0, 0.08}},
                        {{{0.03, 0.03}, {0.03, 0.04}, {0.05, 0.05}, {0.05, 0.03}}}};
  const std::vector<Vector2d> points{{0.1, 0.02}, {0.101, 0.02}, {0.07, 0}};
  PatternMesh mesh = mesh_pattern(pattern, 0.004, points);
  const int fixed = number_points_first(mesh);
  Sheet sheet = test::flat_sheet(mesh.vertices, mesh.triangles);
  Points3 metric = even(sheet, 0.04, 0.04);
  const auto before = sheet.triangles.rows();
  while (collapse_short_edges(sheet, metric, first(fixed, sheet), 0.8) > 0)
    flip_to_delaunay(sheet, metric);
  EXPECT_LT(sheet.triangles.rows(), 0.1 * before);
  double sum = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    EXPECT_GT(test::twice_area(sheet, t), 0);
    sum += 0.5 * test::twice_area(sheet, t);
  }
  EXPECT_NEAR(sum, area(pattern), 1e-12);
  EXPECT_EQ(fixed, 3);
  for (int k = 0; k < fixed; ++k) EXPECT_TRUE(sheet.pattern.row(k) == mesh.vertices.row(k)) << k;
  for (const Vector2d& corner : pattern.holes[0])
    EXPECT_LT((sheet.pattern.rowwise() - corner.transpose()).rowwise().norm().minCoeff(), 1e-12);
  EXPECT_EQ(sheet.pattern.rows(), metric.rows());
}

TEST(EdgeOperationsTest, WhatWasSplitIsNotCollapsedAndAFittingMeshStays) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 4, 0.2);
  Points3 metric = even(sheet, 0.008, 0.02);
  refine(sheet, metric);
  for (int pass = 0; pass < 4; ++pass) {
    while (collapse_short_edges(sheet, metric, first(0, sheet), 0.8) > 0)
      flip_to_delaunay(sheet, metric);
    refine(sheet, metric);
  }
  const Triangles settled = sheet.triangles;
  EXPECT_EQ(split_long_edges(sheet, metric, 100000), 0);
  EXPECT_EQ(flip_to_delaunay(sheet, metric), 0);
  EXPECT_EQ(collapse_short_edges(sheet, metric, first(0, sheet), 0.8), 0);
  EXPECT_TRUE(sheet.triangles == settled);
}

TEST(EdgeOperationsTest, ACollapseDoesNotSweepThroughAnotherLayer) {
  // two layers of one sheet, close above each other
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  const int half = static_cast<int>(sheet.x.rows());
  Points3 x(2 * half, 3);
  Points2 pattern(2 * half, 2);
  Triangles triangles(2 * sheet.triangles.rows(), 3);
  for (int v = 0; v < half; ++v) {
    const double u = sheet.pattern(v, 0) - 0.05, w = sheet.pattern(v, 1) - 0.05;
    x.row(v) << u, w, 0.004 - 0.2 * u * u;          // a flat arch
    x.row(half + v) << u, w, 0.0038 - 0.2 * u * u;  // another one close below it
    pattern.row(v) = sheet.pattern.row(v);
    pattern.row(half + v) = sheet.pattern.row(v) + Eigen::RowVector2d(0.2, 0);
  }
  triangles << sheet.triangles, (sheet.triangles.array() + half).matrix();
  Sheet layers = test::flat_sheet(pattern, triangles);
  layers.x = x;
  ASSERT_EQ(crossings(layers), 0);
  Points3 metric = even(layers, 0.08, 0.08);
  int gone = 0;
  for (int round = 0; round < 6; ++round) {
    const int now = collapse_short_edges(layers, metric, first(0, layers), 0.8);
    flip_to_delaunay(layers, metric);
    gone += now;
  }
  EXPECT_GT(gone, 20);  // along the rulings, and where there is room
  EXPECT_EQ(crossings(layers), 0);
  Sheet alone = test::flat_sheet(sheet.pattern, sheet.triangles);
  alone.x = x.topRows(half);
  Points3 lone_metric = even(alone, 0.08, 0.08);
  for (int round = 0; round < 6; ++round) {
    collapse_short_edges(alone, lone_metric, first(0, alone), 0.8);
    flip_to_delaunay(alone, lone_metric);
  }
  // without the other layer more vertices are removed
  EXPECT_LT(2 * alone.triangles.rows(), layers.triangles.rows());
}

}  // namespace
}  // namespace paperbake
