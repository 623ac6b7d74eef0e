#include "core/geometry/intersections.h"

#include "core/geometry/random.h"
#include "tests/core/test_meshes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace paperbake {
namespace {

using test::hex_sheet;
using test::roll;
using test::strip_sheet;

/// Separate triangles; each has three successive rows of x as its corners.
Sheet soup(const Points3& x) {
  Sheet sheet;
  sheet.x = x;
  sheet.pattern = x.leftCols<2>();
  sheet.triangles.resize(x.rows() / 3, 3);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    sheet.triangles.row(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  return sheet;
}

/// A strip bent along the curve (x(t), z(t)), t in [0, 1].
Sheet strip_along(int cells, const std::function<Vector2d(double)>& curve) {
  Sheet sheet = strip_sheet(0.3, 0.03, cells);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const Vector2d p = curve(sheet.pattern(v, 0) / 0.3);
    sheet.x.row(v) << p.x(), sheet.pattern(v, 1), p.y();
  }
  return sheet;
}

TEST(IntersectionsTest, FlatAndRolledSheetsDoNotIntersectThemselves) {
  Sheet sheet = hex_sheet(0.1, 0.1, 12, 0.2);
  EXPECT_EQ(crossings(sheet), 0);
  roll(sheet, 0.03);
  EXPECT_EQ(crossings(sheet), 0);
}

TEST(IntersectionsTest, StripFoldedOverWithAGapDoesNotIntersectItself) {
  const Sheet sheet = strip_along(
      2, [](double t) { return t < 0.6 ? Vector2d(0.3 * t, 0) : Vector2d(0.01, 1e-6); });
  ASSERT_LT(sheet.x.col(0).maxCoeff(), 0.16);
  EXPECT_EQ(crossings(sheet), 0);
}

TEST(IntersectionsTest, SheetsThatShareABorderTouchAndDoNotIntersect) {
  const double steep = 0.7;  // [rad]
  const Sheet left = strip_sheet(0.3, 0.03, 2);
  Sheet right = left;
  for (int v = 0; v < right.x.rows(); ++v) {
    const double along = right.pattern(v, 0);
    right.x.row(v) << std::cos(steep) * along, right.pattern(v, 1), std::sin(steep) * along;
  }
  EXPECT_EQ(crossings_between(left, right), 0);
  right.x.col(2).array() -= 1e-3;
  EXPECT_GT(crossings_between(left, right), 0);
}

TEST(IntersectionsTest, SpiralWithSeparateTurnsDoesNotIntersectItself) {
  const auto spiral = [](double t) {
    return Vector2d((0.01 + 0.003 * t) * std::cos(18 * t), (0.01 + 0.003 * t) * std::sin(18 * t));
  };
  EXPECT_EQ(crossings(strip_along(200, spiral)), 0);
}

TEST(IntersectionsTest, TwoTrianglesThatPierceAreOneIntersection) {
  Points3 x(6, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, /**/ 0.2, 0.2, -1, 0.3, 0.3, 1, 2, 2, 1;
  EXPECT_EQ(crossings(soup(x)), 1);
  x.bottomRows(3).rowwise() += Eigen::RowVector3d(2, 0, 0);
  EXPECT_EQ(crossings(soup(x)), 0);
}

TEST(IntersectionsTest, NeighbouringTrianglesThatTouchDoNotIntersect) {
  Points3 x(5, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 1, 0, -1, 1;
  Sheet sheet = soup(x.topRows(3));
  sheet.x = x;
  sheet.triangles.resize(2, 3);
  sheet.triangles << 0, 1, 2, 0, 3, 4;  // one vertex in common
  EXPECT_EQ(crossings(sheet), 0);
  sheet.triangles << 0, 1, 2, 1, 0, 4;  // an edge in common
  EXPECT_EQ(crossings(sheet), 0);
}

TEST(IntersectionsTest, TwoTrianglesWithACommonVertexMayIntersect) {
  Points3 x(5, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, /**/ 0.2, 0.2, -0.5, 0.4, 0.4, 0.5;
  Sheet sheet = soup(x.topRows(3));
  sheet.x = x;
  sheet.triangles.resize(2, 3);
  sheet.triangles << 0, 1, 2, 0, 3, 4;  // the edge 3-4 goes through 0-1-2
  EXPECT_EQ(crossings(sheet), 1);
}

TEST(IntersectionsTest, StripThatPassesThroughItselfIntersectsInThreePairs) {
  // a loop whose two legs intersect within one cell each. Of the four pairs of their triangles one
  // does not intersect: the diagonals of the two cells divide the line of intersection at different
  // places
  const auto loop = [](double t) {
    return Vector2d(0.1 * (t + 0.4 * std::sin(2 * M_PI * (t + 0.013))),
                    0.05 * std::cos(2 * M_PI * t));
  };
  EXPECT_EQ(crossings(strip_along(41, loop)), 3);
}

/// Number of intersecting pairs that CGAL's own search finds.
int cgal_crossings(const Sheet& sheet) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  std::vector<CGAL::SM_Vertex_index> vertices;
  for (int v = 0; v < sheet.x.rows(); ++v)
    vertices.push_back(mesh.add_vertex({sheet.x(v, 0), sheet.x(v, 1), sheet.x(v, 2)}));
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    mesh.add_face(vertices[sheet.triangles(t, 0)], vertices[sheet.triangles(t, 1)],
                  vertices[sheet.triangles(t, 2)]);
  std::vector<std::pair<CGAL::SM_Face_index, CGAL::SM_Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
  return static_cast<int>(pairs.size());
}

TEST(IntersectionsTest, NumbersAgreeWithCgalOnRandomTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 1), size(-0.3, 0.3);
  int found = 0;
  for (int k = 0; k < 300; ++k) {
    Points3 x(3 * 20, 3);
    for (int t = 0; t < 20; ++t) {
      const Eigen::RowVector3d centre(place(random), place(random), place(random));
      for (int i = 0; i < 3; ++i)
        x.row(3 * t + i) = centre + Eigen::RowVector3d(size(random), size(random), size(random));
    }
    const Sheet sheet = soup(x);
    const int expected = cgal_crossings(sheet);
    EXPECT_EQ(crossings(sheet), expected) << "soup " << k;
    found += expected;
  }
  EXPECT_GT(found, 1000);
}

/// Whether two triangles of a sheet intersect when it has no others.
bool intersect_alone(const Sheet& sheet, int s, int t) {
  Triangles two(2, 3);
  two << sheet.triangles.row(s), sheet.triangles.row(t);
  return crossings(Sheet{{}, sheet.x, {}, two, {}}) > 0;
}

TEST(IntersectionsTest, ThePairsAreThoseThatACheckOfAllPairsFinds) {
  for (int seed = 0; seed < 4; ++seed) {
    Sheet sheet = hex_sheet(0.1, 0.1, 14, 0.2, seed);
    for (int v = 0; v < sheet.x.rows(); ++v)
      for (int k = 0; k < 3; ++k) sheet.x(v, k) += 8e-3 * uniform(seed, 3 * v + k);
    std::set<std::pair<int, int>> all, found;
    for (int s = 0; s < sheet.triangles.rows(); ++s)
      for (int t = 0; t < s; ++t)
        if (intersect_alone(sheet, s, t)) all.emplace(t, s);
    ASSERT_GT(all.size(), 10u) << seed;
    for (const auto& [s, t] : CrossingCounter(sheet.pattern, sheet.triangles).pairs(sheet.x))
      EXPECT_TRUE(found.emplace(std::min(s, t), std::max(s, t)).second) << "found twice";
    EXPECT_EQ(found, all) << seed;
  }
}

TEST(IntersectionsTest, NumbersAgreeWithCgalOnCrumpledSheets) {
  int found = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Sheet sheet = hex_sheet(0.1, 0.1, 8);
    std::mt19937 random(seed);
    // up to twice the edge length
    std::uniform_real_distribution<double> uniform(-0.0005 * seed, 0.0005 * seed);
    for (int k = 0; k < sheet.x.size(); ++k) sheet.x.data()[k] += uniform(random);
    const int expected = cgal_crossings(sheet);
    EXPECT_EQ(crossings(sheet), expected) << "seed " << seed;
    found += expected;
  }
  EXPECT_GT(found, 1000);
}

}  // namespace
}  // namespace paperbake
