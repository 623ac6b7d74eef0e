#include "core/step1_elastic/energies/ridge_yield.h"

#include "core/model/plastic_grid.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A saddle or bowl: curvature kx along x and ky along y.
Sheet doubly_curved(double kx, double ky, int cells = 8) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, cells);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const Vector2d p = sheet.pattern.row(v).transpose() - Vector2d(0.05, 0.05);
    sheet.x(v, 2) = -0.5 * (kx * p.x() * p.x() + ky * p.y() * p.y());
  }
  return sheet;
}

RidgeField ridges_of(const Sheet& sheet, const std::vector<int>& held,
                     const Eigen::VectorXd& remembered) {
  return find_ridges(sheet, find_hinges(sheet.triangles), Paper{}, held, remembered);
}

RidgeField ridges_of(const Sheet& sheet, const std::vector<int>& held = {}) {
  return ridges_of(sheet, held, Eigen::VectorXd::Zero(sheet.triangles.rows()));
}

TEST(RidgeYieldTest, ACylinderHasNoRidgesHoweverTightItIs) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 12);
  test::roll(sheet, 0.02);
  const RidgeField ridges = ridges_of(sheet);
  EXPECT_EQ(ridges.share.maxCoeff(), 0);
  EXPECT_EQ(ridges.focus.maxCoeff(), 1);
}

TEST(RidgeYieldTest, ASecondBendThatOnlyObtuseTrianglesShowIsNoRidge) {
  // narrow triangles, and a vertex that sits beside the rim of its ring
  constexpr int cells = 6;
  Sheet sheet = test::hex_sheet(0.1, 0.1, cells);
  int middle;
  (sheet.pattern.rowwise() - Eigen::RowVector2d(0.05, 0.05)).rowwise().norm().minCoeff(&middle);
  sheet.pattern.row(middle) += 0.1 / cells * Eigen::RowVector2d(0.6, 0.7);
  sheet.pattern.col(0) *= 0.2;
  test::roll(sheet, 0.004);
  EXPECT_EQ(ridges_of(sheet).share.maxCoeff(), 0);
}

TEST(RidgeYieldTest, CurvatureInTwoDirectionsIsConcentratedToTheWidthOfARidge) {
  const Sheet sheet = doubly_curved(40, -40);  // 40 1/m over a cell of 12 mm: 28 degrees
  const RidgeField ridges = ridges_of(sheet);
  EXPECT_EQ(ridges.share.maxCoeff(), 1);
  // X = sqrt(0.01 m2 / 4) = 50 mm, w = 0.4 (90 um)^(1/3) X^(2/3) = 2.43 mm; a triangle of 12.5 mm
  // is 5.4 to 12.5 mm wide: X/2 is larger
  const double width = 0.4 * std::cbrt(90e-6) * std::pow(0.05, 2.0 / 3);
  EXPECT_NEAR(width, 2.43e-3, 1e-5);
  for (int t = 0; t < ridges.focus.size(); ++t) {
    if (ridges.share[t] < 1) continue;
    EXPECT_NEAR(ridges.focus[t], 0.025 / width, 1e-9 * ridges.focus[t]);
  }
}

TEST(RidgeYieldTest, APrescribedCreaseIsNoRidgeInASheetThatBendsAlongIt) {
  Sheet sheet = doubly_curved(20, 0);  // 20 1/m over a cell of 12 mm: 14 degrees
  const double row = sheet.pattern.col(1).maxCoeff() * 5 / 9;
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) -= 0.5 * std::abs(sheet.pattern(v, 1) - row);
  ASSERT_GT(ridges_of(sheet).share.maxCoeff(), 0.5) << "of paper that was not folded there";
  sheet.prescribed_creases = {{{{0, row}, {0.1, row}}, 0}};
  EXPECT_EQ(ridges_of(sheet).share.maxCoeff(), 0);
}

TEST(RidgeYieldTest, TrianglesLargerThanHalfAFacetConcentrateOverTheirOwnSize) {
  const Sheet sheet = doubly_curved(40, -40, 2);  // cells of 50 mm, X/2 = 25 mm
  const RidgeField ridges = ridges_of(sheet);
  ASSERT_EQ(ridges.share.maxCoeff(), 1);
  EXPECT_GT(ridges.focus.maxCoeff(), 1.2 * 0.025 / ridge_width(Paper{}, 0.05));
}

TEST(RidgeYieldTest, APointLoadIsNoRidge) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  int middle;
  (sheet.pattern.rowwise() - Eigen::RowVector2d(0.05, 0.05)).rowwise().norm().minCoeff(&middle);
  sheet.x(middle, 2) = 0.006;
  const RidgeField free = ridges_of(sheet), held = ridges_of(sheet, {middle});
  EXPECT_GT(free.share.maxCoeff(), 0.5);
  EXPECT_LT(held.share.sum(), 0.6 * free.share.sum());
}

TEST(RidgeYieldTest, OnceARidgeAlwaysARidge) {
  const Sheet sheet = doubly_curved(0, 0);
  const Eigen::VectorXd remembered = Eigen::VectorXd::Constant(sheet.triangles.rows(), 0.7);
  EXPECT_TRUE(ridges_of(sheet, {}, remembered).share == remembered);
}

TEST(RidgeYieldTest, ARidgeYieldsEarlierThanSmoothBending) {
  // 43 1/m of |S|, far below the 100 1/m at which smooth bending yields
  const Sheet sheet = doubly_curved(30, -30);
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  energy.memory = PlasticMemory(static_cast<int>(sheet.triangles.rows()));
  EXPECT_EQ(energy.gained(sheet.x).curvature.norm(), 0);
  energy.ridges = ridges_of(sheet);
  const PlasticMemory gain = energy.gained(sheet.x);
  EXPECT_GT(gain.curvature.norm(), 10);
  for (int t = 0; t < gain.ridge.size(); ++t)
    EXPECT_EQ(gain.ridge[t] > 0, gain.hardening[t] > 0 && energy.ridges.share[t] > 0);
}

TEST(RidgeYieldTest, TheGridKeepsTheSharpestRidgeThatAPlaceEverHad) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  PlasticGrid grid(test::rectangle(0.1, 0.1));
  const PlasticGrid::Cover cover = grid.cover(sheet.pattern, sheet.triangles);
  PlasticMemory sharp(static_cast<int>(sheet.triangles.rows())), blunt = sharp;
  sharp.hardening.setConstant(1);
  sharp.ridge.setConstant(0.8);
  blunt.hardening.setConstant(1);
  blunt.ridge.setConstant(0.3);
  grid.write(cover, sharp);
  grid.write(cover, blunt);
  EXPECT_NEAR(grid.read(cover).ridge.minCoeff(), 0.8, 1e-12);
  EXPECT_NEAR(grid.read(cover).ridge.maxCoeff(), 0.8, 1e-12);
}

}  // namespace
}  // namespace paperbake
