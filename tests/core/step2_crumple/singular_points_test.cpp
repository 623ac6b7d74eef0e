#include "core/step2_crumple/singular_points.h"

#include "core/step2_crumple/conflicts.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace paperbake {
namespace {

TEST(SingularPointsTest, DrawsScatterAroundTheMiddleOfTheConflictByThePapersDeviation) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  const Pattern pattern = test::rectangle(0.1, 0.1);
  int inner = 0;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if ((sheet.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm() <
        (sheet.pattern.row(inner) - Eigen::RowVector2d(0.05, 0.05)).norm())
      inner = v;
  Conflicts conflicts{std::vector<double>(sheet.pattern.rows(), 0.2),
                      std::vector<char>(sheet.pattern.rows(), 1)};
  const Vector2d middle = middle_of_conflict(sheet, conflicts, {inner});
  Paper paper;
  Vector2d mean(0, 0);
  double variance = 0;
  const double spacing = min_spacing(pattern, paper, {});
  constexpr int n = 4000;
  std::set<std::pair<double, double>> places;
  for (unsigned seed = 0; seed < n; ++seed) {
    const auto p = draw_singular_point(sheet, pattern, paper, {middle, spacing}, {}, {seed, 0, 0});
    ASSERT_TRUE(p);
    // the same arguments give the same point: there is no hidden state
    EXPECT_TRUE(*p ==
                *draw_singular_point(sheet, pattern, paper, {middle, spacing}, {}, {seed, 0, 0}));
    places.emplace(p->x(), p->y());
    const Vector2d off = *p - sheet.pattern.row(inner).transpose();
    mean += off / n;
    variance += off.squaredNorm() / (2 * n);
  }
  EXPECT_EQ(places.size(), std::size_t(n));
  EXPECT_LT(mean.norm(), 4 * paper.apex_scatter / std::sqrt(double(n)));
  EXPECT_NEAR(std::sqrt(variance) / paper.apex_scatter, 1, 0.05);
}

/// Mean and standard deviation of 200 draws around one vertex, by direction.
struct Draws {
  Vector2d mean{0, 0}, deviation{0, 0};  // [m]
};
constexpr int draws = 200;
Draws draw_about(const Vector2d& middle, const Paper& paper) {
  const Pattern pattern = test::rectangle(0.1, 0.1);
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  int member = 0;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if ((sheet.pattern.row(v).transpose() - middle).norm() <
        (sheet.pattern.row(member).transpose() - middle).norm())
      member = v;
  sheet.pattern.row(member) = middle.transpose();
  const Conflicts conflicts{std::vector<double>(sheet.pattern.rows(), 0.2),
                            std::vector<char>(sheet.pattern.rows(), 1)};
  const Vector2d aim = middle_of_conflict(sheet, conflicts, {member});
  Draws result;
  std::vector<Vector2d> points;
  for (unsigned seed = 0; seed < draws; ++seed)
    points.push_back(*draw_singular_point(
        sheet, pattern, paper, {aim, min_spacing(pattern, paper, {})}, {}, {seed, 0, 0}));
  for (const Vector2d& p : points) result.mean += p / draws;
  for (const Vector2d& p : points) result.deviation += (p - result.mean).cwiseAbs2() / (draws - 1);
  result.deviation = result.deviation.cwiseSqrt();
  return result;
}

// 200 normal draws determine the deviation within a standard error of 1/sqrt(2 x 199) = 5 % and the
// mean within 1/sqrt(200) deviations; 3.3 standard errors are 99.9 %
TEST(SingularPointsTest, TwoHundredDrawsHaveTheDeviationOfTheGrade) {
  for (const double sigma : {0.002, 0.005, 0.010}) {
    Paper paper;
    paper.apex_scatter = sigma;
    const Draws inside = draw_about({0.05, 0.05}, paper);
    for (int i : {0, 1}) {
      EXPECT_NEAR(inside.deviation[i] / sigma, 1, 3.3 / std::sqrt(2.0 * (draws - 1))) << sigma;
      EXPECT_NEAR(inside.mean[i], 0.05, 3.3 * sigma / std::sqrt(double(draws))) << sigma;
    }
  }
}

// rejected draws are repeated: a normal law truncated at a = (3 mm - middle)/sigma has the mean
// sigma m, m = phi(a)/(1 - Phi(a)), and the variance sigma^2 (1 + a m - m^2)
TEST(SingularPointsTest, DrawsNearTheBorderFollowAGaussianTruncatedAtTheMargin) {
  const Paper paper;
  const double sigma = paper.apex_scatter, margin = CrumpleOptions{}.border_share * 0.1;
  for (const double v : {0.005, 0.008, 0.012}) {
    const Draws near = draw_about({0.05, v}, paper);
    const double a = (margin - v) / sigma;
    const double m =
        std::exp(-0.5 * a * a) / std::sqrt(2 * M_PI) / (0.5 * std::erfc(a / std::sqrt(2.0)));
    const double mean = v + sigma * m, deviation = sigma * std::sqrt(1 + a * m - m * m);
    ASSERT_LT(deviation, 0.97 * sigma) << "the border is not felt: this proves nothing";
    EXPECT_NEAR(near.mean.y(), mean, 3.3 * deviation / std::sqrt(double(draws))) << v;
    // a truncated normal law has lighter tails than 3.3 x 5 % = 17 % allows for
    EXPECT_NEAR(near.deviation.y() / deviation, 1, 0.2) << v;
    EXPECT_NEAR(near.mean.x(), 0.05, 3.3 * sigma / std::sqrt(double(draws))) << v;
    EXPECT_NEAR(near.deviation.x() / sigma, 1, 3.3 / std::sqrt(2.0 * (draws - 1))) << v;
  }
}

TEST(SingularPointsTest, SpacingGrowsWithTheThicknessAndTheSizeOfTheSheet) {
  const Paper paper;
  Paper card;
  card.thickness *= 8;
  const auto spacing = [](double side, const Paper& grade) {
    return min_spacing(test::rectangle(side, side), grade, {});
  };
  EXPECT_NEAR(spacing(0.21, paper), 0.0127, 1e-4);  // 2 x 0.4 (90 um)^(1/3) (0.21 m)^(2/3)
  EXPECT_NEAR(spacing(0.21, card) / spacing(0.21, paper), 2, 1e-12);
  EXPECT_NEAR(spacing(1.68, paper) / spacing(0.21, paper), 4, 1e-12);
  // a stamp has room for a few points, and those of a sail are not too many for its triangles
  EXPECT_LT(spacing(0.002, paper), 0.3 * 0.002);
  EXPECT_GT(spacing(10, paper), 0.01 * 10);
}

TEST(SingularPointsTest, DrawsKeepTheirDistanceFromTheBorderAndOtherPoints) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  const Pattern pattern = test::rectangle(0.1, 0.1);
  const CrumpleOptions options;
  Conflicts conflicts{std::vector<double>(sheet.pattern.rows(), 0.2),
                      std::vector<char>(sheet.pattern.rows(), 1)};
  std::vector<int> members;  // vertices near the front border
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (sheet.pattern(v, 1) < 0.012 && sheet.pattern(v, 1) > 1e-9) members.push_back(v);
  ASSERT_GT(members.size(), 3u);
  const Vector2d middle = middle_of_conflict(sheet, conflicts, members);
  sheet.singular.push_back({Vector2d(0.05, 0.0085), 1, "test"});
  const double spacing = min_spacing(pattern, Paper{}, options);
  for (unsigned seed = 0; seed < 500; ++seed) {
    const auto p =
        draw_singular_point(sheet, pattern, Paper{}, {middle, spacing}, options, {seed, 0, 1});
    if (!p) continue;
    EXPECT_GE((*p - sheet.singular[0].pattern).norm(), spacing);
    EXPECT_GE((nearest_border_point(pattern, *p) - *p).norm(), options.border_share * 0.1 - 1e-12);
  }
}

}  // namespace
}  // namespace paperbake
