#include "core/step1_elastic/solver/predictor.h"
#include "core/model/segment2.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A jittered sheet that is constrained at its borders x = 0 and x = 0.1.
struct Bordered {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 12, 0.15);
  std::vector<int> held;
  Bordered() {
    for (int v = 0; v < sheet.pattern.rows(); ++v)
      if (sheet.pattern(v, 0) < 1e-9 || sheet.pattern(v, 0) > 0.1 - 1e-9) held.push_back(v);
  }
  Predictor predictor() const { return {sheet.pattern, sheet.triangles, held}; }
  Points3 rows_of_held(const Points3& x) const {
    Points3 rows(held.size(), 3);
    for (std::size_t k = 0; k < held.size(); ++k) rows.row(k) = x.row(held[k]);
    return rows;
  }
  /// targets  |held|x3 [m]
  PositionConstraints constraints(const Points3& targets) const {
    PositionConstraints hard;
    for (std::size_t k = 0; k < held.size(); ++k) hard.push_back({held[k], targets.row(k)});
    return hard;
  }
};

/// An arched shape that is a polynomial of second degree in t.
Points3 moving(const Sheet& sheet, double t, double acceleration) {
  Points3 x = sheet.x;
  for (int v = 0; v < x.rows(); ++v) {
    const Vector2d p = sheet.pattern.row(v);
    const Eigen::RowVector3d velocity(0.01 * p.y(), -0.1 * p.x() * p.x(), std::sin(30 * p.x()));
    x.row(v) += t * velocity +
                0.5 * acceleration * t * t * Eigen::RowVector3d(p.y(), 1, std::cos(20 * p.y()));
  }
  return x;
}

constexpr double rounding = 1e-13;  // [m] of a solution with some 200 unknowns of size 0.1

TEST(PredictorTest, ConstrainedVerticesAreExactlyAtTheirTargets) {
  const Bordered g;
  Points3 targets = g.rows_of_held(g.sheet.x);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.05, 0.05);
  for (int k = 0; k < targets.size(); ++k) targets.data()[k] += uniform(random);
  const auto guesses = g.predictor().guesses(
      g.sheet.x, {moving(g.sheet, -1, 0), moving(g.sheet, -2, 0)}, g.constraints(targets));
  ASSERT_EQ(guesses.size(), 3u);
  // to the last bit
  for (const Points3& guess : guesses) EXPECT_EQ(g.rows_of_held(guess), targets);
}

TEST(PredictorTest, ATranslationOfAllHandlesTranslatesTheSheet) {
  const Bordered g;
  const Points3 x = moving(g.sheet, 0.02, 0);  // arched, not flat
  const Eigen::RowVector3d way(0.3, -0.2, 0.5);
  const Points3 guess =
      g.predictor().guesses(x, {}, g.constraints(g.rows_of_held(x).rowwise() + way))[0];
  EXPECT_LT((guess - (x.rowwise() + way)).cwiseAbs().maxCoeff(), rounding);
}

TEST(PredictorTest, ARestingSheetIsGuessedAtRest) {
  const Bordered g;
  const Points3 x = moving(g.sheet, 0.02, 0);
  EXPECT_EQ(g.predictor().guesses(x, {}, g.constraints(g.rows_of_held(x)))[0], x);
}

TEST(PredictorTest, LinearMotionIsPredictedExactly) {
  const Bordered g;
  const double dt = 0.01;
  const Points3 expected = moving(g.sheet, dt, 0), x = moving(g.sheet, 0, 0);
  ASSERT_GT((expected - x).norm(), 0.05);
  const auto guesses =
      g.predictor().guesses(x, {moving(g.sheet, -dt, 0)}, g.constraints(g.rows_of_held(expected)));
  ASSERT_EQ(guesses.size(), 2u);
  // the guess at rest is another one
  EXPECT_GT((guesses[0] - expected).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((guesses[1] - expected).cwiseAbs().maxCoeff(), rounding);
}

TEST(PredictorTest, QuadraticMotionIsPredictedExactly) {
  const Bordered g;
  const double dt = 0.01, acceleration = 50;
  const Points3 expected = moving(g.sheet, dt, acceleration);
  const auto guesses = g.predictor().guesses(
      moving(g.sheet, 0, acceleration),
      {moving(g.sheet, -dt, acceleration), moving(g.sheet, -2 * dt, acceleration)},
      g.constraints(g.rows_of_held(expected)));
  ASSERT_EQ(guesses.size(), 3u);
  EXPECT_GT((guesses[1] - expected).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((guesses[2] - expected).cwiseAbs().maxCoeff(), rounding);
}

/// Smallest area of a triangle in the plane, over its area on the pattern; below 0 it is inverted.
double min_area_kept(const Sheet& sheet, const Points3& x) {
  double least = 1e9;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto area = [&](const auto& at) {
      const Vector2d a = at.row(sheet.triangles(t, 0)), b = at.row(sheet.triangles(t, 1)),
                     c = at.row(sheet.triangles(t, 2));
      return 0.5 * cross(b - a, c - a);
    };
    least = std::min(least, area(x.leftCols<2>()) / area(sheet.pattern));
  }
  return least;
}

TEST(PredictorTest, AJumpOfABorderInvertsNoTriangle) {
  const Bordered g;
  const Predictor predictor = g.predictor();
  // the border x = 0.1 jumps in the plane: nearly onto the other one, far away, sideways, rotated
  // by 30 degrees
  const struct {
    Vector2d way;
    double turn;
  } jumps[] = {{{-0.09, 0}, 0}, {{1, 0}, 0}, {{0, 0.2}, 0}, {{0.05, 0.03}, M_PI / 6}};
  for (const auto& jump : jumps) {
    Points3 targets = g.rows_of_held(g.sheet.x);
    for (std::size_t k = 0; k < g.held.size(); ++k) {
      if (targets(k, 0) < 0.05) continue;
      const Vector2d from_middle = targets.row(k).leftCols<2>().transpose() - Vector2d(0.1, 0.05);
      targets.row(k).leftCols<2>() =
          (Vector2d(0.1, 0.05) + jump.way + Eigen::Rotation2Dd(jump.turn) * from_middle)
              .transpose();
    }
    const Points3 guess = predictor.guesses(g.sheet.x, {}, g.constraints(targets))[0];
    ASSERT_GT((guess - g.sheet.x).norm(), 0.1);
    EXPECT_GT(min_area_kept(g.sheet, guess), 0) << jump.way.transpose() << ", turn " << jump.turn;
  }
}

TEST(PredictorTest, AJumpOfOneBorderIsSpreadEvenlyUpToTheOther) {
  // harmonic with free sides and a constant jump at one end: linear in between, on any mesh
  const Bordered g;
  Points3 targets = g.rows_of_held(g.sheet.x);
  for (int k = 0; k < targets.rows(); ++k)
    if (targets(k, 0) > 0.05) targets.row(k) += Eigen::RowVector3d(-0.03, 0.02, 0.07);
  const Points3 guess = g.predictor().guesses(g.sheet.x, {}, g.constraints(targets))[0];
  for (int v = 0; v < guess.rows(); ++v) {
    const Eigen::RowVector3d expected =
        g.sheet.pattern(v, 0) / 0.1 * Eigen::RowVector3d(-0.03, 0.02, 0.07);
    EXPECT_LT((guess.row(v) - g.sheet.x.row(v) - expected).norm(), rounding);
  }
}

TEST(PredictorTest, NoHarmonicFunctionIsNeededIfAllVerticesOrNoneAreConstrained) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 2);
  std::vector<int> all(sheet.x.rows());
  for (int v = 0; v < sheet.x.rows(); ++v) all[v] = v;
  const Points3 targets = moving(sheet, 1, 2);
  EXPECT_EQ(Predictor(sheet.pattern, sheet.triangles, all)
                .guesses(sheet.x, {}, test::held_at(all, targets))[0],
            targets);
  EXPECT_EQ(Predictor(sheet.pattern, sheet.triangles, {}).guesses(sheet.x, {}, {})[0], sheet.x);
}

}  // namespace
}  // namespace paperbake
