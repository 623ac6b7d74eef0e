#include "core/geometry/proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace paperbake {
namespace {

using Corners = std::array<Vector3d, 4>;

/// Random points in a cube.
struct Dice {
  std::mt19937 random{7};
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  Vector3d point() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
};

/// Expects that these are the closest points of two features, of which the second begins with
/// corner `second`. Both are convex, so they are if and only if the points lie in the features and
/// no corner of either lies beyond the plane through its point across the way between them.
void expect_closest(const ClosestPoints& found, const Corners& x, int second) {
  constexpr double rounding = 1e-12;  // [1] of features that are about as large as 1
  double first_sum = 0, second_sum = 0;
  Vector3d from(0, 0, 0), to(0, 0, 0);
  for (int i = 0; i < 4; ++i) {
    const double weight = i < second ? found.weights[i] : -found.weights[i];
    EXPECT_GE(weight, -rounding) << "corner " << i;
    (i < second ? first_sum : second_sum) += weight;
    (i < second ? from : to) += weight * x[i];
  }
  EXPECT_NEAR(first_sum, 1, rounding);
  EXPECT_NEAR(second_sum, 1, rounding);
  EXPECT_LT((found.apart - (from - to)).norm(), rounding);
  for (int i = 0; i < second; ++i) EXPECT_GE(found.apart.dot(x[i] - from), -rounding) << i;
  for (int i = second; i < 4; ++i) EXPECT_LE(found.apart.dot(x[i] - to), rounding) << i;
}

/// The corners that take part, as bits.
int corners_used(const ClosestPoints& found) {
  int bits = 0;
  for (int i = 0; i < 4; ++i) bits |= (found.weights[i] != 0) << i;
  return bits;
}

TEST(ProximityTest, AVertexIsNearestToTheInteriorASideOrACornerOfATriangle) {
  Dice dice;
  std::set<int> used;
  for (int k = 0; k < 2000; ++k) {
    const Corners x{2 * dice.point(), dice.point(), dice.point(), dice.point()};
    const ClosestPoints found = vertex_to_triangle(x);
    expect_closest(found, x, 1);
    used.insert(corners_used(found));
  }
  EXPECT_EQ(used.size(), 7u) << "three corners, three sides and the interior";
}

TEST(ProximityTest, AVertexAboveATriangleIsAsFarAsItIsHigh) {
  const Corners x{Vector3d(0.2, 0.3, -0.7), Vector3d(0, 0, 0), Vector3d(1, 0, 0),
                  Vector3d(0, 1, 0)};
  const ClosestPoints found = vertex_to_triangle(x);
  EXPECT_LT((found.weights - Eigen::Vector4d(1, -0.5, -0.2, -0.3)).norm(), 1e-14);
  EXPECT_LT((found.apart - Vector3d(0, 0, -0.7)).norm(), 1e-14);
  EXPECT_NEAR(found.distance(), 0.7, 1e-14);
}

TEST(ProximityTest, TwoEdgesAreNearestAtInnerPointsOrAtEnds) {
  Dice dice;
  std::set<int> used;
  for (int k = 0; k < 2000; ++k) {
    const Corners x{2 * dice.point(), dice.point(), 2 * dice.point(), dice.point()};
    const ClosestPoints found = edge_to_edge(x), back = edge_to_edge({x[2], x[3], x[0], x[1]});
    expect_closest(found, x, 2);
    EXPECT_LT((found.apart + back.apart).norm(), 1e-12) << "the same way, seen from the other";
    used.insert(corners_used(found));
  }
  EXPECT_EQ(used.size(), 9u) << "an inner point or one of two ends, on either";
}

TEST(ProximityTest, EdgesThatCrossOrPassEachOtherAreAsFarAsTheyAreHigh) {
  const auto passing = [](double high) {
    return edge_to_edge(
        {Vector3d(-1, 0, high), Vector3d(3, 0, high), Vector3d(0, -1, 0), Vector3d(0, 1, 0)});
  };
  EXPECT_LT((passing(0.3).weights - Eigen::Vector4d(0.75, 0.25, -0.5, -0.5)).norm(), 1e-14);
  EXPECT_LT((passing(0.3).apart - Vector3d(0, 0, 0.3)).norm(), 1e-14);
  EXPECT_EQ(passing(0).distance(), 0);
}

// Parallel edges beside each other, one after the other, on one line, and as good as parallel.
TEST(ProximityTest, ParallelEdgesAreNearestWhereTheyOverlapOrAtTheirEnds) {
  Dice dice;
  for (int k = 0; k < 600; ++k) {
    const Vector3d along = dice.point(), from = dice.point(), aside = dice.point();
    const double a = dice.number(), b = dice.number(), shift = 3 * dice.number();
    Corners x{from, from + a * along, from + shift * along, from + (shift + b) * along};
    for (int i : {2, 3}) x[i] += k % 3 == 0 ? Vector3d(0, 0, 0) : aside;
    if (k % 2) x[3] += 1e-9 * dice.point();
    SCOPED_TRACE(k);
    const ClosestPoints found = edge_to_edge(x);
    ASSERT_TRUE(found.weights.allFinite());
    double least = 1e9;  // at an end of one of them at least
    for (int i = 0; i < 4; ++i) {
      const Vector3d &p = x[i], &q = x[i < 2 ? 2 : 0], way = x[i < 2 ? 3 : 1] - q;
      const double share = std::clamp((p - q).dot(way) / way.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (p - q - share * way).norm());
    }
    // a turn of 1e-9 may be taken for none
    EXPECT_NEAR(found.distance(), least, k % 2 ? 1e-8 : 1e-14);
  }
}

TEST(ProximityTest, AnEdgeWithoutLengthIsAPoint) {
  Dice dice;
  for (int k = 0; k < 300; ++k) {
    const Vector3d p = 2 * dice.point(), a = dice.point(), b = dice.point();
    for (const Corners& x : {Corners{p, p, a, b}, Corners{a, b, p, p}, Corners{p, p, a, a}}) {
      const ClosestPoints found = edge_to_edge(x);
      ASSERT_TRUE(found.weights.allFinite());
      expect_closest(found, x, 2);
    }
  }
}

TEST(ProximityTest, AnEdgePiercesATriangleThatItsLineMeetsInsideBetweenItsEnds) {
  Dice dice;
  int piercing = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vector3d p = dice.point(), q = dice.point();
    const std::array<Vector3d, 3> t{dice.point(), dice.point(), dice.point()};
    // p + s (q - p) = t0 + u (t1 - t0) + v (t2 - t0)
    Eigen::Matrix3d columns;
    columns << p - q, t[1] - t[0], t[2] - t[0];
    const Vector3d suv = columns.inverse() * (p - t[0]);
    const bool inside = suv.minCoeff() > 0 && suv[0] < 1 && suv[1] + suv[2] < 1;
    piercing += inside;
    EXPECT_EQ(pierces(p, q, t), inside) << k;
    EXPECT_EQ(pierces(q, p, {t[1], t[0], t[2]}), inside) << k;
  }
  EXPECT_GT(piercing, 100);
}

TEST(ProximityTest, AnEdgeThatTouchesATriangleDoesNotPierceIt) {
  const std::array<Vector3d, 3> t{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const Vector3d up(0, 0, 1), inside(0.25, 0.25, 0), side(0.5, 0, 0);
  EXPECT_TRUE(pierces(inside - up, inside + up, t));
  EXPECT_FALSE(pierces(inside, inside + up, t)) << "it stands on it";
  EXPECT_FALSE(pierces(side - up, side + up, t)) << "it passes a side";
  EXPECT_FALSE(pierces(t[2] - up, t[2] + up, t)) << "it passes a corner";
  EXPECT_FALSE(pierces(Vector3d(-1, 0.25, 0), Vector3d(1, 0.25, 0), t)) << "it lies on it";
}

/// Area of the part of a triangle that lies within a tetrahedron: the triangle cut off at the
/// planes of the four faces.
double area_within(const std::array<Vector3d, 3>& triangle, const Corners& c) {
  std::vector<Vector3d> part(triangle.begin(), triangle.end());
  for (int i = 0; i < 4; ++i) {
    const Vector3d a = c[(i + 1) % 4];
    Vector3d inwards = (c[(i + 2) % 4] - a).cross(c[(i + 3) % 4] - a).normalized();
    if (inwards.dot(c[i] - a) < 0) inwards = -inwards;
    std::vector<Vector3d> cut;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const Vector3d &p = part[k], &q = part[(k + 1) % part.size()];
      const double hp = inwards.dot(p - a), hq = inwards.dot(q - a);
      if (hp >= 0) cut.push_back(p);
      if ((hp >= 0) != (hq >= 0)) cut.push_back(p + hp / (hp - hq) * (q - p));
    }
    part = cut;
  }
  Vector3d doubled(0, 0, 0);
  for (std::size_t k = 2; k < part.size(); ++k)
    doubled += (part[k - 1] - part[0]).cross(part[k] - part[0]);
  return 0.5 * doubled.norm();
}

/// A sheet of one triangle, of the vertices 0, 1, 2; `first` is its first corner.
Sheet lone_triangle(const std::array<Vector3d, 3>& x, int first = 0) {
  Sheet sheet;
  sheet.x.resize(3, 3);
  for (int i = 0; i < 3; ++i) sheet.x.row(i) = x[i];
  sheet.triangles.resize(1, 3);
  sheet.triangles << first, (first + 1) % 3, (first + 2) % 3;
  return sheet;
}

// The triangle has no vertex, one or two in common with the tetrahedron, at any of its corners.
TEST(ProximityTest, ATetrahedronIsEmptyIfNoPartOfATriangleLiesInIt) {
  Dice dice;
  int decided[3][2] = {};
  for (int k = 0; k < 6000; ++k) {
    const int common = k % 3, first = k / 3 % 4, second = (first + 1 + k / 12 % 3) % 4;
    const Corners c{dice.point(), dice.point(), dice.point(), dice.point()};
    std::array<Vector3d, 3> x{dice.point(), dice.point(), dice.point()};
    std::array<int, 4> vertices{10, 11, 12, -1};
    if (common > 0) vertices[first] = 0, x[0] = c[first];
    if (common > 1) vertices[second] = 1, x[1] = c[second];
    const double within = area_within(x, c);
    if (within > 0 && within < 1e-9) continue;  // rounding decides
    ++decided[common][within == 0];
    const Sheet sheet = lone_triangle(x, k / 36 % 3);
    EXPECT_EQ(tetrahedron_is_empty(sheet, vertices, c, {}, 0), within == 0) << common << ", " << k;
    EXPECT_TRUE(tetrahedron_is_empty(sheet, vertices, c, {0}, 0)) << "the triangle is changing";
  }
  for (const auto& of_common : decided)
    for (const int count : of_common) EXPECT_GT(count, 200);
}

TEST(ProximityTest, ATetrahedronIsNotEmptyIfALayerIsCloserToItsLastEdgeThanTheClearance) {
  // the edge 2-3 is on top, along x; the layer above it ends on both sides of it
  const Corners c{Vector3d(0, -1, -1), Vector3d(0, 1, -1), Vector3d(-1, 0, 0), Vector3d(1, 0, 0)};
  constexpr double high = 0.01;
  const Sheet above =
      lone_triangle({Vector3d(0, -3, high), Vector3d(0.5, 3, high), Vector3d(-0.5, 3, high)});
  EXPECT_TRUE(tetrahedron_is_empty(above, {5, 6, 7, -1}, c, {}, 0.99 * high));
  EXPECT_FALSE(tetrahedron_is_empty(above, {5, 6, 7, -1}, c, {}, 1.01 * high));
  EXPECT_TRUE(tetrahedron_is_empty(above, {5, 6, 7, -1}, c, {0}, 1.01 * high)) << "it is changing";
  EXPECT_TRUE(tetrahedron_is_empty(above, {5, 6, 2, -1}, c, {}, 1.01 * high)) << "a neighbour";
  EXPECT_FALSE(tetrahedron_is_empty(above, {5, 2, 6, -1}, c, {}, 1.01 * high));
  // as far from the edges at the other corners, and far from the last one
  const Sheet beside =
      lone_triangle({Vector3d(0, 1 + high, -3), Vector3d(0, 1 + high, 3), Vector3d(0, 2, 0)});
  EXPECT_TRUE(tetrahedron_is_empty(beside, {5, 6, 7, -1}, c, {}, 2 * high));
}

TEST(ProximityTest, AnEdgeOfEitherTriangleMayPierceTheOther) {
  Points3 x(7, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, -0.1, 0.2, 0.2, 0.3, 5, 5, 0.1, 0.2, 0.2, 0.1;
  Triangles triangles(5, 3);
  triangles << 0, 1, 2, 3, 4, 5, 0, 3, 4, 0, 1, 4, 4, 5, 6;
  const auto pierce = [&](int s, int t) {
    EXPECT_EQ(pierce_each_other(x, triangles, s, t), pierce_each_other(x, triangles, t, s));
    return pierce_each_other(x, triangles, s, t);
  };
  EXPECT_TRUE(pierce(0, 1));
  EXPECT_TRUE(pierce(0, 2)) << "though they have a corner in common";
  EXPECT_FALSE(pierce(0, 3)) << "neighbours";
  EXPECT_FALSE(pierce(0, 4)) << "above it";
}

TEST(ProximityTest, TheDistanceOfFeaturesIsTheLeastOfAllPairs) {
  const TriangleCorners flat{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)},
      standing{Vector3d(0.2, 0.2, 0.3), Vector3d(0.2, 0.2, 2), Vector3d(2, 2, 2)},
      beside{Vector3d(2, -1, 0), Vector3d(2, 1, 0), Vector3d(3, 0, 0)};
  EXPECT_NEAR(feature_distance(flat, standing), 0.3, 1e-14);
  EXPECT_NEAR(feature_distance(standing, flat), 0.3, 1e-14);
  EXPECT_NEAR(feature_distance(flat, beside), 1, 1e-14);
}

}  // namespace
}  // namespace paperbake
