#include "core/geometry/point_location.h"

#include "core/geometry/pattern_mesh.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

constexpr double exact = 1e-14;  // [m] a few rounding errors of numbers below 0.3
// [1] tolerance of the locator: on an edge it may find either triangle
constexpr double border_weight = 1e-9;

/// What a grid of cells has to cope with: a jittered sheet, a long strip of slivers between
/// rulings, and an L with a hole.
std::vector<Sheet> sheets() {
  const Pattern ell{{{0, 0}, {0.2, 0}, {0.2, 0.1}, {0.1, 0.1}, {0.1, 0.2}, {0, 0.2}},
                    {{{0.04, 0.04}, {0.04, 0.06}, {0.06, 0.06}, {0.06, 0.04}}}};
  PatternMesh mesh = mesh_pattern(ell, 0.013, {});
  return {test::hex_sheet(0.1, 0.1, 12, 0.2), test::strip_sheet(0.3, 0.03, 200),
          test::flat_sheet(std::move(mesh.vertices), std::move(mesh.triangles))};
}

Vector2d point_at(const MeshPoint& place, const Sheet& sheet) {
  Vector2d p = Vector2d::Zero();
  for (int i = 0; i < 3; ++i)
    p += place.weights[i] * sheet.pattern.row(sheet.triangles(place.triangle, i)).transpose();
  return p;
}

TEST(PointLocationTest, EveryVertexIsFoundAtACornerOfWeightOne) {
  for (const Sheet& sheet : sheets()) {
    const PointLocator locator(sheet.pattern, sheet.triangles);
    for (int v = 0; v < sheet.pattern.rows(); ++v) {
      const MeshPoint place = locator.locate(sheet.pattern.row(v));
      int corner;
      EXPECT_NEAR(place.weights.maxCoeff(&corner), 1, border_weight);
      EXPECT_EQ(sheet.triangles(place.triangle, corner), v);
    }
  }
}

TEST(PointLocationTest, EveryCentroidIsFoundInItsTriangleWithEqualWeights) {
  for (const Sheet& sheet : sheets()) {
    const PointLocator locator(sheet.pattern, sheet.triangles);
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      Vector2d centroid = Vector2d::Zero();
      for (int i = 0; i < 3; ++i)
        centroid += sheet.pattern.row(sheet.triangles(t, i)).transpose() / 3;
      const MeshPoint place = locator.locate(centroid);
      EXPECT_EQ(place.triangle, t);
      EXPECT_LT((place.weights - Vector3d::Constant(1.0 / 3)).norm(), 1e-12);
    }
  }
}

TEST(PointLocationTest, WeightsReproduceThePoint) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Sheet& sheet : sheets()) {
    const PointLocator locator(sheet.pattern, sheet.triangles);
    for (int k = 0; k < 2000; ++k) {  // random points of random triangles
      const int t = static_cast<int>(uniform(random) * sheet.triangles.rows());
      double a = uniform(random), b = uniform(random);
      if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
      }
      const Vector2d p = point_at({t, Vector3d(1 - a - b, a, b)}, sheet);
      const MeshPoint place = locator.locate(p);
      EXPECT_LT((point_at(place, sheet) - p).norm(), exact);
      EXPECT_GE(place.weights.minCoeff(), -border_weight);
      EXPECT_NEAR(place.weights.sum(), 1, 1e-14);
    }
  }
}

TEST(PointLocationTest, InterpolationOfALinearFunctionIsExact) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 12, 0.2);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const Vector2d p = sheet.pattern.row(v);
    sheet.x.row(v) << 1 + 2 * p.x() - p.y(), 3 * p.x(), 5 - 4 * p.y();
  }
  const PointLocator locator(sheet.pattern, sheet.triangles);
  for (double x = 0.0005; x < 0.1; x += 0.0037)
    for (double y = 0.0005; y < 0.1; y += 0.0041) {
      const Vector3d value = interpolate(locator.locate({x, y}), sheet.triangles, sheet.x);
      EXPECT_LT((value - Vector3d(1 + 2 * x - y, 3 * x, 5 - 4 * y)).norm(), 1e-14);
    }
}

TEST(PointLocationTest, PointOutsideIsMappedToTheNearestPointOfTheMesh) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 12);
  const PointLocator locator(sheet.pattern, sheet.triangles);
  const struct {
    Vector2d asked, nearest;
  } cases[] = {{{0.031, -0.02}, {0.031, 0}}, {{0.1001, 0.07}, {0.1, 0.07}},
               {{0.05, 5}, {0.05, 0.1}},     {{-1e-13, 0.033}, {0, 0.033}},
               {{-1, -2}, {0, 0}},           {{0.2, 0.3}, {0.1, 0.1}}};
  for (const auto& c : cases) {
    const MeshPoint place = locator.locate(c.asked);
    // the nearest point on a line: rounding errors only
    EXPECT_LT((point_at(place, sheet) - c.nearest).norm(), 1e-12) << c.asked.transpose();
    EXPECT_GE(place.weights.minCoeff(), -border_weight);
    EXPECT_LE(place.weights.maxCoeff(), 1 + border_weight);
  }
}

TEST(PointLocationTest, PointInAHoleOrANotchIsMappedToItsNearestRim) {
  const Sheet sheet = sheets()[2];
  const PointLocator locator(sheet.pattern, sheet.triangles);
  EXPECT_LT((point_at(locator.locate({0.045, 0.05}), sheet) - Vector2d(0.04, 0.05)).norm(), 1e-12);
  EXPECT_LT((point_at(locator.locate({0.12, 0.15}), sheet) - Vector2d(0.1, 0.15)).norm(), 1e-12);
  EXPECT_LT((point_at(locator.locate({0.19, 0.101}), sheet) - Vector2d(0.19, 0.1)).norm(), 1e-12);
}

}  // namespace
}  // namespace paperbake
