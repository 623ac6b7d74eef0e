#include "core/step2_crumple/lone_cone.h"

#include "core/geometry/curvature.h"
#include "core/step2_crumple/crumple.h"
#include "tests/core/test_cones.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

const Pattern square = test::rectangle(0.1, 0.1);

/// A d-cone about a point of a square of 0.1 m, on triangles with edges of 0.1 m / `edges`.
Sheet d_cone(const Vector2d& apex, int edges, double slope = 0.5) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, edges, 0.25, 5);
  sheet.pattern.rowwise() -= apex.transpose();
  test::bend_to_wavy_cone(sheet, slope, test::d_cone_lobe);
  sheet.pattern.rowwise() += apex.transpose();
  return sheet;
}

std::optional<Vector2d> apex_of(const Sheet& sheet) {
  return apex_of_lone_cone(sheet, square, vertex_curvature(sheet));
}

/// |V| 1: the vertex nearest to p
std::vector<char> held_at(const Sheet& sheet, const Vector2d& p) {
  std::vector<char> held(sheet.pattern.rows(), 0);
  Eigen::Index nearest;
  (sheet.pattern.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  held[nearest] = 1;
  return held;
}

/// A sheet that has bent like this for 40 frames.
Sheet crumpled(Sheet sheet, const std::vector<char>& held) {
  Crumple crumple(square, Paper{}, {}, 1, 0);
  const auto stored = [&]() -> LocalEnergies {
    return {Eigen::VectorXd::Zero(sheet.triangles.rows()),
            Eigen::VectorXd::Zero(sheet.triangles.rows()), Points2::Zero(sheet.pattern.rows(), 2)};
  };
  for (int frame = 1; frame <= 40; ++frame)
    crumple.step(sheet, held, {frame}, {0.005, true, true}, stored);
  return sheet;
}

TEST(LoneConeTest, TheApexOfADConeIsFoundOnAFewTriangles) {
  for (const int edges : {7, 12, 20})
    for (const Vector2d& apex : {Vector2d(0.05, 0.05), Vector2d(0.062, 0.043)})
      for (const double slope : {0.2, 0.5, 0.9}) {
        const Sheet sheet = d_cone(apex, edges, slope);
        const auto found = apex_of(sheet);
        ASSERT_TRUE(found) << edges << " " << slope;
        EXPECT_LT((*found - apex).norm(), 0.1 / edges) << edges << " " << slope;
        EXPECT_FALSE(is_apex_taken(sheet, {}, *found));
        EXPECT_TRUE(is_apex_taken(sheet, held_at(sheet, apex), *found));
        EXPECT_FALSE(is_apex_taken(sheet, held_at(sheet, {0, 0}), *found));
      }
}

TEST(LoneConeTest, OtherSheetsAreNone) {
  const Sheet flat = test::hex_sheet(0.1, 0.1, 10);
  EXPECT_FALSE(apex_of(flat));
  Sheet cylinder = flat;
  test::roll(cylinder, 0.03);
  EXPECT_FALSE(apex_of(cylinder));
  Sheet bent = flat;  // in one narrow band
  for (int v = 0; v < bent.x.rows(); ++v) bent.x(v, 2) = std::abs(bent.pattern(v, 0) - 0.053);
  EXPECT_FALSE(apex_of(bent));
  Sheet cone = flat;
  test::bend_to_cone(cone, {-0.03, 0.05}, 1);  // its apex lies beside the paper
  EXPECT_FALSE(apex_of(cone));
  Sheet waves = flat;
  for (int v = 0; v < waves.x.rows(); ++v)
    waves.x(v, 2) =
        0.002 * std::sin(130 * waves.pattern(v, 0)) * std::sin(110 * waves.pattern(v, 1));
  EXPECT_FALSE(apex_of(waves));
}

TEST(LoneConeTest, AConeGetsItsApexAndNoOtherSingularPoint) {
  const Vector2d apex(0.052, 0.047);
  const Sheet sheet = d_cone(apex, 7, 0.9);
  const Sheet free = crumpled(sheet, std::vector<char>(sheet.pattern.rows(), 0));
  ASSERT_EQ(free.singular.size(), 1u);
  const double scatter = 4 * Paper{}.apex_scatter;
  EXPECT_LT((free.singular[0].pattern - apex).norm(), 0.1 / 7 + scatter);
  EXPECT_TRUE(crumpled(sheet, held_at(sheet, apex)).singular.empty());
  Sheet born = sheet;
  born.singular.push_back({apex, 1, "test"});
  EXPECT_EQ(crumpled(born, std::vector<char>(sheet.pattern.rows(), 0)).singular.size(), 1u);
}

}  // namespace
}  // namespace paperbake
