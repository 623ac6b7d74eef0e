#include "core/step1_elastic/solver/panel_motion.h"

#include "core/geometry/rigid_motion.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

constexpr double side = 0.1;  // [m]

/// A grid of n x n squares, each of two triangles, folded along its middle in one or both
/// directions.
struct Folded {
  static constexpr int n = 6;
  Sheet sheet;
  Hinges hinges;
  std::vector<bool> folded;

  explicit Folded(bool twice) {
    Points2 pattern((n + 1) * (n + 1), 2);
    for (int v = 0; v < pattern.rows(); ++v)
      pattern.row(v) << side * (v % (n + 1)) / n, side * (v / (n + 1)) / n;
    Triangles triangles(2 * n * n, 3);
    for (int k = 0; k < n * n; ++k) {
      const int v = k / n * (n + 1) + k % n;
      triangles.row(2 * k) << v, v + 1, v + n + 2;
      triangles.row(2 * k + 1) << v, v + n + 2, v + n + 1;
    }
    sheet = test::flat_sheet(pattern, triangles);
    hinges = find_hinges(triangles);
    for (const Hinge& hinge : hinges.hinges) {
      const Vector2d a = pattern.row(hinge.vertices[0]), b = pattern.row(hinge.vertices[1]);
      const bool first = std::abs(a.x() - side / 2) + std::abs(b.x() - side / 2) < 1e-9,
                 second = std::abs(a.y() - side / 2) + std::abs(b.y() - side / 2) < 1e-9;
      folded.push_back(first || (twice && second));
    }
  }

  Panels panels() const { return {sheet.triangles, hinges, folded}; }
  int vertex(int column, int row) const { return row * (n + 1) + column; }
};

/// A turn about the line x = side/2, z = 0 of the part beyond it. [rad]
Vector3d turned(Vector3d x, double angle) {
  if (x.x() <= side / 2) return x;
  const Vector3d axis(side / 2, 0, 0);
  return axis + Eigen::AngleAxisd(-angle, Vector3d::UnitY()) * (x - axis);
}

Points3 turned(Points3 x, double angle) {
  for (int v = 0; v < x.rows(); ++v) x.row(v) = turned(Vector3d(x.row(v)), angle);
  return x;
}

PositionConstraints held_at(const Points3& x, const std::vector<int>& vertices) {
  PositionConstraints hard;
  for (const int v : vertices) hard.push_back({v, x.row(v)});
  return hard;
}

TEST(PanelMotionTest, PanelsOfAFoldTurnWithTheHandsThatHoldThem) {
  const Folded fold(false);
  const Points3 before = turned(fold.sheet.x, 1), after = turned(fold.sheet.x, 1.4);
  const PositionConstraints hands =
      held_at(after, {fold.vertex(0, 0), fold.vertex(1, 0), fold.vertex(0, 5), fold.vertex(6, 6),
                      fold.vertex(5, 6), fold.vertex(6, 1)});
  const std::optional<Points3> moved = fold.panels().moved(before, hands);
  ASSERT_TRUE(moved);
  EXPECT_LT((*moved - after).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(PanelMotionTest, APanelThatNobodyHoldsGoesWithTheFoldsOfItsNeighbours) {
  const Folded fold(true);
  const Points3 before = fold.sheet.x;
  const RigidMotion away{Eigen::AngleAxisd(0.3, Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
                         {0.01, 0.02, 0.03}};
  Points3 after = before;
  for (int v = 0; v < after.rows(); ++v) after.row(v) = away(before.row(v));
  // three quarters are held, the fourth shares two folds that are not in one line with them
  const PositionConstraints hands =
      held_at(after, {fold.vertex(0, 0), fold.vertex(1, 0), fold.vertex(0, 1), fold.vertex(6, 0),
                      fold.vertex(5, 0), fold.vertex(6, 1), fold.vertex(0, 6), fold.vertex(1, 6),
                      fold.vertex(0, 5)});
  const std::optional<Points3> moved = fold.panels().moved(before, hands);
  ASSERT_TRUE(moved);
  EXPECT_LT((*moved - after).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(PanelMotionTest, NothingIsSaidOfASheetThatIsNotFoldedOrThatNoHandHolds) {
  Folded fold(false);
  const Points3& x = fold.sheet.x;
  const std::vector<int> corner{fold.vertex(0, 0), fold.vertex(1, 0), fold.vertex(0, 1)};
  EXPECT_TRUE(fold.panels().moved(x, held_at(x, corner)));
  EXPECT_FALSE(fold.panels().moved(x, held_at(x, {corner[0], corner[1]}))) << "two lie in one line";
  fold.folded.assign(fold.folded.size(), false);
  EXPECT_FALSE(fold.panels().moved(x, held_at(x, corner)));
}

TEST(PanelMotionTest, HalfWayOfATurnIsHalfTheTurnAndNotTheChord) {
  const Folded fold(false);
  const Points3 before = turned(fold.sheet.x, 1), middle = turned(fold.sheet.x, 1.2),
                after = turned(fold.sheet.x, 1.4);
  const std::vector<int> flap{fold.vertex(6, 6), fold.vertex(5, 6), fold.vertex(6, 1)};
  PositionConstraints hands = held_at(after, flap);
  for (const PositionConstraint& half : fold.panels().half_way(before, hands))
    EXPECT_LT((half.target - middle.row(half.vertex).transpose()).norm(), 1e-12);
  // two handles hold no plate: they go along the chord
  hands.pop_back();
  for (const PositionConstraint& half : fold.panels().half_way(before, hands))
    EXPECT_LT(
        (half.target - 0.5 * (before.row(half.vertex) + after.row(half.vertex)).transpose()).norm(),
        1e-15);
}

}  // namespace
}  // namespace paperbake
