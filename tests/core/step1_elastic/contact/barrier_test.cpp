#include "core/step1_elastic/contact/barrier.h"

#include <gtest/gtest.h>

#include <random>

namespace paperbake {
namespace {

using Corners = std::array<Vector3d, 4>;

TEST(BarrierTest, SlopeAndSecondAreDerivativesOfTheValue) {
  const double dhat = 2e-3, step = 1e-9;
  for (const double d : {1e-5, 2e-4, 1e-3, 1.9e-3}) {
    const Barrier b = barrier(d, dhat);
    ASSERT_LT(b.slope, -1e-6);
    EXPECT_NEAR((barrier(d + step, dhat).value - barrier(d - step, dhat).value) / (2 * step),
                b.slope, 1e-5 * std::abs(b.slope) + 1e-7);
    EXPECT_NEAR((barrier(d + step, dhat).slope - barrier(d - step, dhat).slope) / (2 * step),
                b.second, 1e-5 * b.second + 1e-4);
    EXPECT_GE(b.second, 0);
  }
  EXPECT_EQ(barrier(dhat, dhat).value, 0);
  EXPECT_EQ(barrier(dhat, dhat).slope, 0);
}

TEST(BarrierTest, NoFastVertexPassesThroughATriangleNorAnEdgeThroughAnEdge) {
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

TEST(BarrierTest, AVertexThatFliesStraightAtATriangleGoesFourFifthsOfTheGap) {
  const Corners x{Vector3d(0, 0, 1), Vector3d(-3, -3, 0), Vector3d(3, -3, 0), Vector3d(0, 3, 0)};
  const Corners move{Vector3d(0, 0, -100), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  EXPECT_NEAR(100 * collision_free_step(x, move, Features::vertex_and_triangle), 0.8, 0.01);
}

TEST(BarrierTest, AVertexThatSlidesFarOverATriangleInATightGapIsHardlyHeldUp) {
  const Corners x{Vector3d(0.2, 0.2, 1e-7), Vector3d(0, 0, 0), Vector3d(1, 0, 0),
                  Vector3d(0, 1, 0)};
  Corners move{Vector3d(0.3, 0.1, -4e-9), Vector3d(0, 0, 0), Vector3d(0, 0, 0), Vector3d(0, 0, 0)};
  // steps of what is left of the gap would need millions
  EXPECT_EQ(collision_free_step(x, move, Features::vertex_and_triangle), 1);
  move[0].z() = -2e-7;
  // a twentieth of a tight gap may be used
  EXPECT_NEAR(collision_free_step(x, move, Features::vertex_and_triangle), 0.5 * (1 - 0.95), 1e-3);
}

}  // namespace
}  // namespace paperbake
