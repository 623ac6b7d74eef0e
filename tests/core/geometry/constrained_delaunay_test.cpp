#include "core/geometry/constrained_delaunay.h"

#include "core/model/segment2.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

namespace paperbake {
namespace {

using Edges = std::vector<std::pair<int, int>>;

/// The region and the edges to be triangulated.
struct Input {
  std::vector<Vector2d> points;
  Edges border, chords;

  /// Adds a closed polygon; returns the number of its first point.
  int add_loop(const std::vector<Vector2d>& loop) {
    const int first = static_cast<int>(points.size()), n = static_cast<int>(loop.size());
    points.insert(points.end(), loop.begin(), loop.end());
    for (int k = 0; k < n; ++k) border.emplace_back(first + k, first + (k + 1) % n);
    return first;
  }
  std::optional<Triangles> triangulated() const {
    return constrained_delaunay(points, border, chords);
  }
};

std::vector<Vector2d> square(double from, double to) {
  return {{from, from}, {to, from}, {to, to}, {from, to}};
}

/// A square with points anywhere in it.
Input random_square(int inside, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.01, 0.99);
  Input input;
  input.add_loop(square(0, 1));
  for (int k = 0; k < inside; ++k) {
    const double right = uniform(random), up = uniform(random);
    input.points.emplace_back(right, up);
  }
  return input;
}

double area_of(const std::vector<Vector2d>& points, const Triangles& triangles) {
  double sum = 0;
  for (const auto& t : triangles.rowwise())
    sum += signed_area(points[t[0]], points[t[1]], points[t[2]]);
  return sum;
}

/// Expects counter-clockwise triangles without overlap that have every edge of the input, cover
/// this area, and whose other edges are locally Delaunay: the far corner of the triangle beyond
/// such an edge is not within the circumcircle of the one before it.
void expect_constrained_delaunay(const Input& input, const Triangles& triangles, double area) {
  std::map<std::pair<int, int>, int> beyond;  // far corner, by the directed edge
  for (const auto& t : triangles.rowwise())
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(signed_area(input.points[t[0]], input.points[t[1]], input.points[t[2]]), 0);
      EXPECT_TRUE(beyond.insert({{t[i], t[(i + 1) % 3]}, t[(i + 2) % 3]}).second) << "an overlap";
    }
  EXPECT_NEAR(area_of(input.points, triangles), area, 1e-12);
  std::set<std::pair<int, int>> kept;
  for (const Edges* edges : {&input.border, &input.chords})
    for (const auto& [a, b] : *edges) {
      EXPECT_TRUE(beyond.count({a, b}) || beyond.count({b, a})) << a << "-" << b << " is missing";
      kept.insert(std::minmax(a, b));
    }
  for (const auto& [edge, far] : beyond) {
    const auto other = beyond.find({edge.second, edge.first});
    if (kept.count(std::minmax(edge.first, edge.second))) continue;
    ASSERT_NE(other, beyond.end()) << "the border is part of the input";
    Eigen::Matrix3d in_circle;  // seen from the far corner of the other triangle
    int row = 0;
    for (const int v : {edge.first, edge.second, far}) {
      const Vector2d from = input.points[v] - input.points[other->second];
      in_circle.row(row++) << from.x(), from.y(), from.squaredNorm();
    }
    EXPECT_LE(in_circle.determinant(), 1e-12) << edge.first << "-" << edge.second;
  }
}

TEST(ConstrainedDelaunayTest, PointsInASquareGetTheirDelaunayTriangles) {
  for (const int inside : {0, 1, 5, 40, 300}) {
    const Input input = random_square(inside, static_cast<unsigned>(inside));
    const std::optional<Triangles> triangles = input.triangulated();
    ASSERT_TRUE(triangles);
    EXPECT_EQ(triangles->rows(), 2 + 2 * inside) << "by Euler's formula";
    expect_constrained_delaunay(input, *triangles, 1);
  }
}

TEST(ConstrainedDelaunayTest, ChordsAreEdgesAlsoWhereNoneWouldBe) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Input input = random_square(30, seed);
    const Triangles without = input.triangulated().value();
    // a long chord across the others' triangles, in two pieces
    const int first = static_cast<int>(input.points.size());
    for (const Vector2d& p : {Vector2d(0.005, 0.5), Vector2d(0.7, 0.503), Vector2d(0.995, 0.4)})
      input.points.push_back(p);
    input.chords = {{first + 1, first}, {first + 1, first + 2}};
    const std::optional<Triangles> with = input.triangulated();
    ASSERT_TRUE(with);
    EXPECT_EQ(with->rows(), without.rows() + 6);
    expect_constrained_delaunay(input, *with, 1);
  }
}

TEST(ConstrainedDelaunayTest, ChordsOnBothSidesOfARegionDoNotEndIt) {
  // a ring of chords is no border: the paper goes on inside it
  Input input;
  input.add_loop(square(0, 3));
  const int first = input.add_loop(square(1, 2));
  input.chords.assign(input.border.begin() + 4, input.border.end());
  input.border.resize(4);
  ASSERT_EQ(input.chords.front().first, first);
  const std::optional<Triangles> triangles = input.triangulated();
  ASSERT_TRUE(triangles);
  expect_constrained_delaunay(input, *triangles, 9);
}

TEST(ConstrainedDelaunayTest, ARegionWithinAnOddNumberOfPolygonsIsPaper) {
  Input input;  // a square with a hole, and a piece of paper in the hole, which has a hole
  double area = 0, sign = 1;
  for (const double margin : {0.0, 1.0, 2.5, 3.0}) {
    std::vector<Vector2d> loop = square(margin, 8 - margin);
    // in either orientation
    if (margin == 1.0 || margin == 2.5) std::reverse(loop.begin(), loop.end());
    input.add_loop(loop);
    area += sign * (8 - 2 * margin) * (8 - 2 * margin);
    sign = -sign;
  }
  const std::optional<Triangles> triangles = input.triangulated();
  ASSERT_TRUE(triangles);
  EXPECT_EQ(triangles->rows(), 16) << "eight in each of two rings";
  expect_constrained_delaunay(input, *triangles, area);
}

TEST(ConstrainedDelaunayTest, OfABayInTheOutlineNothingIsPaper) {
  Input input;
  input.add_loop({{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  const std::optional<Triangles> triangles = input.triangulated();
  ASSERT_TRUE(triangles);
  EXPECT_EQ(triangles->rows(), 6);
  expect_constrained_delaunay(input, *triangles, 5);
}

// Such a side bends inwards here and there, by rounding, and what is outside has an area, too.
TEST(ConstrainedDelaunayTest, PointsOfASideThatRoundingBendsGiveNoTriangleOutside) {
  std::vector<Vector2d> loop;
  for (int k = 0; k <= 20; ++k) loop.push_back(Vector2d(0.1, 0) + k / 20.0 * Vector2d(0.2, 0.7));
  loop.emplace_back(-1, 0.4);
  Input input;
  input.add_loop(loop);
  const std::optional<Triangles> triangles = input.triangulated();
  ASSERT_TRUE(triangles);
  EXPECT_EQ(triangles->rows(), 22 - 2) << "as every polygon of 22 sides";
}

TEST(ConstrainedDelaunayTest, EdgesThatCrossHaveNoTriangulation) {
  Input bow_tie;
  bow_tie.add_loop({{0, 0}, {1, 1}, {1, 0}, {0, 1}});
  EXPECT_FALSE(bow_tie.triangulated());

  Input chords = random_square(0, 1);
  chords.chords = {{0, 2}};
  EXPECT_TRUE(chords.triangulated());
  chords.chords.emplace_back(1, 3);
  EXPECT_FALSE(chords.triangulated()) << "two chords, whose crossing is no point";
  chords.points.emplace_back(0.5, 0.5);
  EXPECT_FALSE(chords.triangulated()) << "and not if it is one, through which they pass";
  chords.chords = {{0, 4}, {4, 2}, {1, 4}, {4, 3}};
  EXPECT_TRUE(chords.triangulated()) << "but if they end there";
}

TEST(ConstrainedDelaunayTest, AnEdgeThroughAPointHasNoTriangulation) {
  Input border;  // the first side passes through the second corner but one
  border.add_loop({{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}});
  EXPECT_FALSE(border.triangulated());
  Input chord = random_square(0, 1);
  chord.points.emplace_back(0.25, 0.25);
  EXPECT_TRUE(chord.triangulated());
  chord.chords = {{0, 2}};
  EXPECT_FALSE(chord.triangulated());
}

TEST(ConstrainedDelaunayTest, EqualPointsHaveNoTriangulation) {
  Input input = random_square(3, 1);
  ASSERT_TRUE(input.triangulated());
  input.points.push_back(input.points[5]);
  EXPECT_FALSE(input.triangulated());
}

}  // namespace
}  // namespace paperbake
