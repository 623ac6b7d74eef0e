#include "core/step1_elastic/contact/additive_ccd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace paperbake {
namespace {

using Corners = std::array<Vector3d, 4>;

TEST(AdditiveCcdTest, WhatIsCertainlyFreeGoesAllTheWay) {
  // a vertex that comes straight down to a triangle, in gaps on both sides of what counts as tight
  const Corners still{Vector3d::Zero(), Vector3d(-3, -3, 0), Vector3d(3, -3, 0), Vector3d(0, 3, 0)};
  int free = 0, held = 0;
  for (const double gap : {5e-13, 2e-8, 9e-8, 1.1e-7, 5e-7, 2e-6, 1e-3, 1.0})
    for (const double share : {0.01, 0.04, 0.06, 0.5, 0.79, 0.81, 1.5}) {
      Corners x = still, move{Vector3d(0, 0, -share * gap), Vector3d::Zero(), Vector3d::Zero(),
                              Vector3d::Zero()};
      x[0].z() = gap;
      const double step = collision_free_step(x, move, Features::vertex_and_triangle);
      EXPECT_EQ(is_certainly_free(gap, share * gap), step == 1) << gap << " " << share;
      // also if the gap is larger than is known
      EXPECT_LE(is_certainly_free(0.9 * gap, share * gap), step == 1) << gap << " " << share;
      ++(step == 1 ? free : held);
    }
  EXPECT_GT(free, 10);
  EXPECT_GT(held, 10);
}

TEST(AdditiveCcdTest, NoFastVertexPassesThroughATriangleNorAnEdgeThroughAnEdge) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  int stopped = 0;
  for (int k = 0; k < 4000; ++k) {
    const Features features = k % 2 ? Features::two_edges : Features::vertex_and_triangle;
    Corners x, move;
    for (int i = 0; i < 4; ++i) {
      x[i] = point();
      move[i] = 5 * point();
    }
    const double share = collision_free_step(x, move, features),
                 d = closest_points(x, features).distance();
    ASSERT_GE(share, 0);
    ASSERT_LE(share, 1);
    stopped += share < 1;
    for (int i = 1; i <= 200; ++i) {
      Corners at;
      for (int j = 0; j < 4; ++j) at[j] = x[j] + share * i / 200 * move[j];
      ASSERT_GT(closest_points(at, features).distance(), 0.19 * d) << k;
    }
  }
  EXPECT_GT(stopped, 500);
}

TEST(AdditiveCcdTest, AVertexThatFliesStraightAtATriangleGoesFourFifthsOfTheGap) {
  const Corners x{Vector3d(0, 0, 1), Vector3d(-3, -3, 0), Vector3d(3, -3, 0), Vector3d(0, 3, 0)};
  const Corners move{Vector3d(0, 0, -100), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  EXPECT_NEAR(100 * collision_free_step(x, move, Features::vertex_and_triangle), 0.8, 0.01);
}

TEST(AdditiveCcdTest, AVertexThatSlidesFarOverATriangleInATightGapIsHardlyHeldUp) {
  const Corners x{Vector3d(0.2, 0.2, 1e-7), Vector3d(0, 0, 0), Vector3d(1, 0, 0),
                  Vector3d(0, 1, 0)};
  Corners move{Vector3d(0.3, 0.1, -4e-9), Vector3d(0, 0, 0), Vector3d(0, 0, 0), Vector3d(0, 0, 0)};
  // steps of what is left of the gap would need millions
  EXPECT_EQ(collision_free_step(x, move, Features::vertex_and_triangle), 1);
  move[0].z() = -2e-7;
  // a twentieth of a tight gap may be used
  EXPECT_NEAR(collision_free_step(x, move, Features::vertex_and_triangle), 0.5 * (1 - 0.95), 1e-3);
}

TEST(AdditiveCcdTest, EdgesThatFlyStraightAtEachOtherGoFourFifthsOfTheGap) {
  // both move, each by its share of the gap of 1
  const Corners x{Vector3d(-1, 0, 1), Vector3d(1, 0, 1), Vector3d(0, -1, 0), Vector3d(0, 1, 0)};
  const Corners move{Vector3d(0, 0, -30), Vector3d(0, 0, -30), Vector3d(0, 0, 10),
                     Vector3d(0, 0, 10)};
  EXPECT_NEAR(40 * collision_free_step(x, move, Features::two_edges), 0.8, 0.01);
}

/// Two features 0.1 apart at a random place, on their way to each other.
Corners near_each_other(std::mt19937& random, Features features) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Corners x;
  do {
    for (Vector3d& corner : x)
      for (int i = 0; i < 3; ++i) corner[i] = uniform(random);
  } while (closest_points(x, features).distance() < 1e-3);
  const Vector3d apart = closest_points(x, features).apart;
  for (int i = 0; i < second_of(features); ++i) x[i] += (0.1 - apart.norm()) * apart.normalized();
  return x;
}

TEST(AdditiveCcdTest, OnlyMovesAgainstEachOtherCount) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int stopped = 0;
  for (int k = 0; k < 400; ++k) {
    const Features features = k % 2 ? Features::two_edges : Features::vertex_and_triangle;
    const Corners x = near_each_other(random, features);
    Corners move, carried;
    for (Vector3d& m : move)
      for (int i = 0; i < 3; ++i) m[i] = uniform(random);
    const Vector3d with(100 * uniform(random), 20, -50);
    for (int i = 0; i < 4; ++i) carried[i] = move[i] + with;
    const double share = collision_free_step(x, move, features);
    EXPECT_NEAR(collision_free_step(x, carried, features), share, 1e-9) << k;
    EXPECT_NEAR(relative_move(carried, features), relative_move(move, features), 1e-9);
    EXPECT_EQ(collision_free_step(x, {with, with, with, with}, features), 1) << "as one body";
    stopped += share < 1;
  }
  EXPECT_GT(stopped, 50);
}

TEST(AdditiveCcdTest, FeaturesThatFlyApartGoAllTheWay) {
  std::mt19937 random(10);
  for (int k = 0; k < 400; ++k) {
    const Features features = k % 2 ? Features::two_edges : Features::vertex_and_triangle;
    const Corners x = near_each_other(random, features);
    Corners move{};
    for (Vector3d& m : move) m.setZero();
    for (int i = 0; i < second_of(features); ++i) move[i] = 100 * closest_points(x, features).apart;
    EXPECT_EQ(collision_free_step(x, move, features), 1) << k;
    for (Vector3d& m : move) m *= -1;
    // straight at each other: four fifths of the gap at most, and not much less
    EXPECT_NEAR(100 * collision_free_step(x, move, features), 0.8, 0.01) << k;
  }
}

TEST(AdditiveCcdTest, FeaturesThatTouchDoNotMove) {
  // what rounding leaves between a vertex and a triangle has no direction
  const Corners rounded{Vector3d(0.2, 0.2, 0), Vector3d(0, 0, 0), Vector3d(1, 0, 0),
                        Vector3d(0, 1, 0)};
  ASSERT_GT(closest_points(rounded, Features::vertex_and_triangle).distance(), 0);
  const Corners vertex{Vector3d(0.25, 0.25, 0), Vector3d(0, 0, 0), Vector3d(1, 0, 0),
                       Vector3d(0, 1, 0)},
      edges{Vector3d(-1, 0, 0), Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 1, 0)};
  for (const double up : {-0.1, 0.1}) {
    const Corners move{Vector3d(0, 0, up), Vector3d(0, 0, 0), Vector3d(0, 0, 0), Vector3d(0, 0, 0)};
    EXPECT_EQ(collision_free_step(vertex, move, Features::vertex_and_triangle), 0);
    EXPECT_EQ(collision_free_step(rounded, move, Features::vertex_and_triangle), 0);
    EXPECT_EQ(collision_free_step(edges, move, Features::two_edges), 0);
  }
}

TEST(AdditiveCcdTest, TheRelativeMoveIsThatOfTheTwoCornersThatMoveMostAgainstEachOther) {
  // corner 1 belongs to the second feature only if the first one is a vertex
  const Corners move{Vector3d(-5, 0, 0), Vector3d(5, 0, 0), Vector3d(0, 3, 0), Vector3d(0, 0, 4)};
  EXPECT_DOUBLE_EQ(relative_move(move, Features::vertex_and_triangle), 10);
  EXPECT_DOUBLE_EQ(relative_move(move, Features::two_edges), std::sqrt(25 + 16));
}

}  // namespace
}  // namespace paperbake
