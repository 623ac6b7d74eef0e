// Sheets that begin rolled or folded.

#include "core/animation/start_mesh.h"

#include "core/animation/initial_sheet.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {
namespace {

constexpr double length = 0.3, width = 0.04;  // [m]

/// A strip as an artist models it: a grid of columns x 4 faces, whose cross section is a curve by
/// arc length s. [m]
Shot modelled(int columns, const std::function<Vector2d(double s)>& curve) {
  constexpr int rows = 4;
  Shot shot = test::blank_shot(test::rectangle(length, width));
  Sheet& start = shot.start;
  start.pattern.resize((columns + 1) * (rows + 1), 2);
  start.x.resize(start.pattern.rows(), 3);
  start.triangles.resize(2 * columns * rows, 3);
  int t = 0;
  for (int i = 0; i <= columns; ++i)
    for (int j = 0; j <= rows; ++j) {
      const int v = i * (rows + 1) + j;
      const double s = length * i / columns, y = width * j / rows;
      const Vector2d p = curve(s);
      start.pattern.row(v) << s, y;
      start.x.row(v) << p.x(), y, p.y();
      if (i == columns || j == rows) continue;
      start.triangles.row(t++) << v, v + rows + 1, v + rows + 2;
      start.triangles.row(t++) << v, v + rows + 2, v + 1;
    }
  return shot;
}

/// Three and a half turns, 1.2 mm apart, about a hole of 23 mm.
Shot rolled(int columns = 160) {
  constexpr double inner = 0.0115, pitch = 0.0012 / (2 * M_PI);
  return modelled(columns, [](double s) {
    // the arc length of a spiral with so small a pitch is that of its circles
    const double turn = (std::sqrt(inner * inner + 2 * pitch * s) - inner) / pitch,
                 radius = inner + pitch * turn;
    return Vector2d(radius * std::cos(turn), radius * std::sin(turn));
  });
}

/// A third of the strip is flat, and the rest is rolled up over it in two turns of flat facets that
/// turn by about 15 degrees each.
/// pitch  [m] between the layers
Shot rolled_up_at_one_end(double pitch = 2e-4) {
  constexpr int columns = 85, flat = 28;
  constexpr double facet = length / columns, outer = 0.0139;
  std::vector<Vector2d> at{{0, 0}};
  double turn = 0;
  for (int i = 0; i < columns; ++i) {
    if (i >= flat) turn += (i == flat ? 0.5 : 1) * facet / (outer - pitch * turn / (2 * M_PI));
    at.push_back(at.back() + facet * Vector2d(std::cos(turn), std::sin(turn)));
  }
  return modelled(columns,
                  [at](double s) { return at[static_cast<std::size_t>(std::lround(s / facet))]; });
}

/// Two flat halves at 150 degrees.
Shot folded() {
  constexpr double slope = 75 * M_PI / 180;
  return modelled(2, [](double s) {
    const double from_fold = s - length / 2;
    return Vector2d(from_fold * std::cos(slope), std::abs(from_fold) * std::sin(slope));
  });
}

MethodChoice hybrid_of(const Shot& shot) { return hybrid(shot.pattern, shot.paper, 120, {}, 0, 0); }

TEST(StartMeshTest, BendsOfAGridAreItsColumns) {
  const std::vector<Bend> bends = bends_of(rolled(60).start);
  ASSERT_EQ(bends.size(), 59u);  // not at the two ends
  const double sum = 3.509 * 2 * M_PI * 59 / 60;
  double turn = 0;
  for (const Bend& bend : bends) {
    EXPECT_NEAR((bend.b - bend.a).norm(), width, 1e-12);
    EXPECT_NEAR(bend.a.x(), bend.b.x(), 1e-12);
    turn += bend.turn;
  }
  EXPECT_NEAR(turn, sum, 0.01 * sum);
}

class StartMeshOfMethod : public testing::TestWithParam<const char*> {
 protected:
  static MethodChoice choice(const Shot& shot) {
    const std::string name = GetParam();
    if (name == "fem") return fem(400);
    if (name == "adaptive") return adaptive(shot.pattern, 3000);
    return hybrid_of(shot);
  }
};

// An edge that a method's own mesh cuts across the roll is a chord of a wide arc.
TEST_P(StartMeshOfMethod, ARollBeginsWithTheRightLengthsAndDoesNotIntersectItself) {
  const Shot shot = rolled();
  const std::unique_ptr<Method> method = choice(shot).make();
  const Sheet sheet = make_initial_sheet(shot, *method, 1).sheet;
  EXPECT_LT(length_distortion(sheet).largest, 0.002);
  EXPECT_EQ(crossings(sheet), 0);
}

// Its first facet turns by little, and an edge that crosses the bend there near its end is hardly
// too short. But it runs through the layer below.
TEST_P(StartMeshOfMethod, ARollThatLiesOnItsFlatEndDoesNotPassThroughIt) {
  const Shot shot = rolled_up_at_one_end();
  ASSERT_EQ(crossings(shot.start), 0);
  const std::unique_ptr<Method> method = choice(shot).make();
  EXPECT_EQ(crossings(make_initial_sheet(shot, *method, 1).sheet), 0);
}

TEST_P(StartMeshOfMethod, AFoldedLeafHasItsFoldAmongTheEdges) {
  const Shot shot = folded();
  const std::unique_ptr<Method> method = choice(shot).make();
  const Sheet sheet = make_initial_sheet(shot, *method, 1).sheet;
  EXPECT_LT(length_distortion(sheet).largest, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Methods, StartMeshOfMethod, testing::Values("hybrid", "fem", "adaptive"),
                         [](const auto& info) { return std::string(info.param); });

TEST(StartMeshTest, ASheetThatTheMethodsOwnMeshCanShowKeepsIt) {
  // an arch of 0.2 radians: between two columns of the first mesh it turns by a hundredth of that
  const Shot shot = modelled(60, [](double s) {
    const double radius = length / 0.2, turn = s / radius;
    return Vector2d(radius * std::sin(turn), radius * std::cos(turn));
  });
  const std::unique_ptr<Method> method = hybrid_of(shot).make(), same = hybrid_of(shot).make();
  const StartMesh start = mesh_of_start(shot, *method, {});
  const PatternMesh own = same->first_mesh(shot.pattern, {});
  EXPECT_FALSE(start.has_bends);
  EXPECT_EQ(start.mesh.vertices, own.vertices);
  EXPECT_EQ(start.mesh.triangles, own.triangles);
}

// Handles that stand on a fold are there only as exactly as a file says.
TEST(StartMeshTest, AFoldGoesThroughTheHandlesThatStandOnIt) {
  const Shot shot = folded();
  const std::unique_ptr<Method> method = hybrid_of(shot).make();
  const std::vector<Vector2d> points = {
      {length / 2 + 1e-6, 0}, {length / 2 - 1e-6, width / 2}, {length / 2, width - 1e-3}};
  const StartMesh start = mesh_of_start(shot, *method, points);
  ASSERT_TRUE(start.has_bends);
  int on_fold = 0;
  for (const auto& p : start.mesh.vertices.rowwise())
    on_fold += std::abs(p.x() - length / 2) < 2e-6;
  EXPECT_GE(on_fold, 4);
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_LT((start.mesh.vertices.row(start.mesh.point_vertex[k]) - points[k].transpose()).norm(),
              1e-9);
}

// No mesh parts what passes through itself as it was modelled.
TEST(StartMeshTest, ARollThatIsModelledThroughItselfGetsNoFinerMeshThanOneThatIsNot) {
  const Shot apart = rolled_up_at_one_end(), through = rolled_up_at_one_end(1e-4);
  ASSERT_GT(crossings(through.start), 0);
  const std::unique_ptr<Method> one = hybrid_of(apart).make(), other = hybrid_of(through).make();
  EXPECT_LE(mesh_of_start(through, *other, {}).mesh.triangles.rows(),
            mesh_of_start(apart, *one, {}).mesh.triangles.rows());
}

TEST(StartMeshTest, BendsAreNotFixed) {
  const Shot shot = rolled();
  const std::unique_ptr<Method> method = hybrid_of(shot).make();
  const InitialSheet started = make_initial_sheet(shot, *method, 1);
  EXPECT_EQ(std::count(started.fixed.begin(), started.fixed.end(), 1), 0);
}

}  // namespace
}  // namespace paperbake
