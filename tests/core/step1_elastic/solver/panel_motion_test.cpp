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

  Panels panels() const { return {sheet.pattern, sheet.triangles, hinges, folded}; }
  std::vector<double> unpressed() const { return std::vector<double>(folded.size(), 0.0); }
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
  const std::optional<Points3> moved = fold.panels().moved(before, hands, fold.unpressed());
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
  const std::optional<Points3> moved = fold.panels().moved(before, hands, fold.unpressed());
  ASSERT_TRUE(moved);
  EXPECT_LT((*moved - after).cwiseAbs().maxCoeff(), 1e-12);
}

/// A square of which three quarters are held, and the fourth is folded along its diagonal.
TEST(PanelMotionTest, TwoPanelsThatTurnAboutFoldsStayTogetherAtTheFoldBetweenThem) {
  const Points2 pattern =
      (Points2(9, 2) << 0, 0, 1, 0, 2, 0, 0, 1, 1, 1, 2, 1, 0, 2, 1, 2, 2, 2).finished();
  const Triangles triangles =
      (Triangles(8, 3) << 0, 1, 4, 0, 4, 3, 1, 2, 4, 2, 5, 4, 3, 4, 6, 4, 7, 6, 4, 5, 8, 4, 8, 7)
          .finished();
  const Hinges hinges = find_hinges(triangles);
  std::vector<bool> folded;
  std::size_t diagonal = 0;
  for (std::size_t h = 0; h < hinges.hinges.size(); ++h) {
    const auto& v = hinges.hinges[h].vertices;
    const Vector2d way = pattern.row(v[1]) - pattern.row(v[0]);
    const bool fourth = v[0] + v[1] == 12;
    folded.push_back(way.x() == 0 || way.y() == 0 || fourth);
    if (fourth) diagonal = h;
  }
  const Points3 before = test::flat_sheet(pattern, triangles).x;
  // the quarters turn down by these angles about the lines between them
  const double a = 0.7, b = 0.4;
  const Vector3d middle(1, 1, 0);
  const auto moved_by = [&](int v, double angle, const Vector3d& axis) {
    return Vector3d(middle + Eigen::AngleAxisd(angle, axis) * (before.row(v).transpose() - middle));
  };
  PositionConstraints hands;
  for (const int v : {0, 1, 3, 4}) hands.push_back({v, before.row(v)});
  for (const int v : {2, 5}) hands.push_back({v, moved_by(v, a, Vector3d::UnitY())});
  for (const int v : {6, 7}) hands.push_back({v, moved_by(v, -b, Vector3d::UnitX())});
  for (const double side : {1.0, -1.0}) {
    std::vector<double> pressed(hinges.hinges.size(), 0.0);
    pressed[diagonal] = side;
    const auto moved = Panels(pattern, triangles, hinges, folded).moved(before, hands, pressed);
    ASSERT_TRUE(moved);
    for (const int v : {4, 5, 7})
      EXPECT_NEAR((moved->row(8) - moved->row(v)).norm(), (before.row(8) - before.row(v)).norm(),
                  1e-12);
    EXPECT_GT(side * dihedral_angle(*moved, hinges.hinges[diagonal]), 0.1);
  }
}

TEST(PanelMotionTest, NothingIsSaidOfASheetThatIsNotFoldedOrThatNoHandHolds) {
  Folded fold(false);
  const Points3& x = fold.sheet.x;
  const std::vector<int> corner{fold.vertex(0, 0), fold.vertex(1, 0), fold.vertex(0, 1)};
  EXPECT_TRUE(fold.panels().moved(x, held_at(x, corner), fold.unpressed()));
  EXPECT_FALSE(fold.panels().moved(x, held_at(x, {corner[0], corner[1]}), fold.unpressed()))
      << "two lie in one line";
  fold.folded.assign(fold.folded.size(), false);
  EXPECT_FALSE(fold.panels().moved(x, held_at(x, corner), fold.unpressed()));
}

TEST(PanelMotionTest, ThePatternSaysNothingOfAPanelThatOnlyItsFoldHolds) {
  const Folded fold(false);
  const Points3 after = turned(fold.sheet.x, 1.4);
  const std::vector<int> left{fold.vertex(0, 0), fold.vertex(1, 0), fold.vertex(0, 5)},
      both{left[0], left[1], left[2], fold.vertex(6, 6), fold.vertex(5, 6), fold.vertex(6, 1)};
  const auto moved = fold.panels().moved_from_pattern(held_at(after, both), fold.unpressed());
  ASSERT_TRUE(moved);
  EXPECT_LT((*moved - after).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_FALSE(fold.panels().moved_from_pattern(held_at(after, left), fold.unpressed()))
      << "flat, the flap would leap open";
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
