#include "core/methods/adaptive_mesh/sizing_field.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// Sizes of the field at the vertex nearest to a point: across x, across y. [m]
Vector2d sizes_at(const Sheet& sheet, const Points3& field, const Vector2d& p) {
  Eigen::Index v;
  (sheet.pattern.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&v);
  return {1 / std::sqrt(field(v, 0)), 1 / std::sqrt(field(v, 2))};
}

constexpr double side = 0.1;

Sheet cylinder(double radius) {
  Sheet sheet = test::hex_sheet(side, side, 20);
  test::roll(sheet, radius);
  return sheet;
}

TEST(SizingFieldTest, OnACylinderSizesAreAFacetAcrossTheRulingsAndLongAlongThem) {
  SizingOptions options;
  options.edge_turn = 0.2;
  for (const double radius : {0.05, 0.03}) {
    const Sheet sheet = cylinder(radius);
    const Vector2d sizes = sizes_at(sheet, sizing_field(sheet, {}, side, options), {0.05, 0.05});
    // the curvature of the facets is as accurate as this
    EXPECT_NEAR(sizes.x() / (options.edge_turn * radius), 1, 0.05) << radius;
    EXPECT_NEAR(sizes.y() / std::min(0.25 * side, options.aspect * options.edge_turn * radius), 1,
                0.05)
        << radius;
  }
}

TEST(SizingFieldTest, OptionsBoundTheSizes) {
  const Sheet sheet = cylinder(0.03);
  const auto sizes = [&](const SizingOptions& options) {
    return sizes_at(sheet, sizing_field(sheet, {}, side, options), {0.05, 0.05});
  };
  SizingOptions by_default, round, coarse, small;
  round.aspect = 1.5;
  coarse.smallest = 0.1;  // of the longer side
  small.largest = 0.12;
  EXPECT_NEAR(sizes(round).y() / sizes(round).x(), 1.5, 0.05);
  EXPECT_NEAR(sizes(coarse).x(), 0.1 * side, 1e-6);
  EXPECT_NEAR(sizes(small).y(), 0.12 * side, 1e-4);
  EXPECT_LT(sizes(by_default).x(), 0.08 * side);
  EXPECT_GT(sizes(by_default).y(), 0.15 * side);
}

TEST(SizingFieldTest, SizesGrowAwayFromACreaseWithinTheirLimit) {
  Sheet sheet = test::hex_sheet(side, side, 40);
  // a roof along y
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 0.5 * std::abs(sheet.pattern(v, 0) - 0.05);
  SizingOptions slow, quick;
  slow.growth = 1.2;
  quick.growth = 2.5;
  const Points3 a = sizing_field(sheet, {}, side, slow), b = sizing_field(sheet, {}, side, quick);
  const double crest = sizes_at(sheet, a, {0.05, 0.05}).x(),
               beside = sizes_at(sheet, a, {0.06, 0.05}).x(),
               beside_quick = sizes_at(sheet, b, {0.06, 0.05}).x();
  EXPECT_LT(crest, 0.05 * side);
  // d size / d x <= growth - 1, plus one edge of the test mesh
  EXPECT_LT(beside, 1.2 * crest + 0.25 * 0.01);
  EXPECT_GT(beside_quick, 1.5 * beside);
  EXPECT_NEAR(sizes_at(sheet, b, {0.01, 0.05}).y(), 0.25 * side, 1e-6);  // it is flat there
}

TEST(SizingFieldTest, CompressionAloneNeedsNoFinerMesh) {
  Sheet sheet = test::hex_sheet(side, side, 8);
  for (const double strain : {0.0, 0.003, 0.2}) {
    sheet.x.col(0) = (1 - strain) * sheet.pattern.col(0);
    EXPECT_LT((sizes_at(sheet, sizing_field(sheet, {}, side, {}), {0.05, 0.05}) -
               0.25 * side * Vector2d::Ones())
                  .norm(),
              1e-9)
        << strain;
  }
}

TEST(SizingFieldTest, AFlattenedCreaseKeepsItsTriangles) {
  const Sheet sheet = test::hex_sheet(side, side, 20);
  Points3 kept = Points3::Zero(sheet.x.rows(), 3);
  for (int v = 0; v < sheet.x.rows(); ++v)
    kept(v, 2) = 60 * std::exp(-std::pow((sheet.pattern(v, 1) - 0.05) / 0.01, 2));
  const Points3 field = sizing_field(sheet, kept, side, {});
  EXPECT_NEAR(sizes_at(sheet, field, {0.05, 0.05}).y() / (0.25 / 60), 1, 0.1);
  EXPECT_GT(sizes_at(sheet, field, {0.05, 0.0}).y(), 0.02);
}

}  // namespace
}  // namespace paperbake
