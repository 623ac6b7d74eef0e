#include "core/render/untangle.h"
#include "core/geometry/intersections.h"

#include "core/geometry/measure.h"
#include "core/render/strain_limit.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

constexpr double leg = 0.045, gap = 1e-3;  // [m]

/// Where a point of the pattern is on a strip folded to a U, whose legs bend towards each other by
/// `bulge`. [m]
Vector3d folded(const Vector2d& p, double bulge) {
  const double bend = M_PI * gap / 2, s = p.x();
  if (s < leg) return {s, p.y(), bulge * std::sin(M_PI * s / leg)};
  if (s > leg + bend)
    return {2 * leg + bend - s, p.y(), gap - bulge * std::sin(M_PI * (s - leg - bend) / leg)};
  const double turn = M_PI * (s - leg) / bend;
  return {leg + 0.5 * gap * std::sin(turn), p.y(), 0.5 * gap * (1 - std::cos(turn))};
}

Sheet strip(double bulge) {
  // irregular, so that nowhere edge meets edge between layers
  Sheet sheet = test::hex_sheet(2 * leg + M_PI * gap / 2, 0.02, 60, 0.2);
  for (int v = 0; v < sheet.x.rows(); ++v) sheet.x.row(v) = folded(sheet.pattern.row(v), bulge);
  return sheet;
}

Vector3d on_facets(const Vector2d& p) { return folded(p, 0); }

TEST(UntangleTest, IntersectingLayersGoBackNoFartherThanTheFacets) {
  const Sheet linear_positions = strip(0), curved = strip(0.8e-3);
  ASSERT_EQ(crossings(linear_positions), 0);
  ASSERT_GT(crossings(curved), 20);
  Sheet apart = curved;
  const std::vector<char> held(apart.x.rows(), 0);
  EXPECT_TRUE(
      Untangler(apart.pattern, apart.triangles)(apart.x, linear_positions.x, on_facets, held)
          .changed);
  EXPECT_EQ(crossings(apart), 0);
  // nearly half a gap of the bulge may stay
  EXPECT_GT((apart.x - linear_positions.x).rowwise().norm().maxCoeff(), 0.2e-3);
  EXPECT_LE((apart.x - linear_positions.x).rowwise().norm().maxCoeff(), 0.8e-3);
  // the chords of the mesh shorten the bend
  EXPECT_LT(length_distortion(apart).largest, length_distortion(linear_positions).largest + 0.01);
}

TEST(UntangleTest, LayersThatDoNotIntersectAreNotMoved) {
  const Sheet linear_positions = strip(0), curved = strip(0.4e-3);
  ASSERT_EQ(crossings(curved), 0);
  Sheet apart = curved;
  const std::vector<char> held(apart.x.rows(), 0);
  EXPECT_FALSE(
      Untangler(apart.pattern, apart.triangles)(apart.x, linear_positions.x, on_facets, held)
          .changed);
  EXPECT_EQ(apart.x, curved.x);
}

TEST(UntangleTest, HeldVerticesStay) {
  const Sheet linear_positions = strip(0), curved = strip(0.8e-3);
  Sheet apart = curved;
  std::vector<char> held(apart.x.rows(), 0);
  for (int v = 0; v < apart.x.rows(); ++v) held[v] = apart.pattern(v, 0) < leg;
  EXPECT_TRUE(
      Untangler(apart.pattern, apart.triangles)(apart.x, linear_positions.x, on_facets, held)
          .changed);
  double moved = 0;
  for (int v = 0; v < apart.x.rows(); ++v) {
    if (held[v])
      EXPECT_EQ(apart.x.row(v), curved.x.row(v));
    else
      moved = std::max(moved, (apart.x.row(v) - curved.x.row(v)).norm());
  }
  EXPECT_GT(moved, 0.1e-3);
}

TEST(UntangleTest, IfTheFacetsIntersectTooContactPointsGoToTheirPlaces) {
  const Sheet curved = strip(0.502e-3);
  ASSERT_GT(crossings(curved), 5);
  Sheet apart = curved;
  const std::vector<char> held(apart.x.rows(), 0);
  EXPECT_TRUE(
      Untangler(apart.pattern, apart.triangles)(apart.x, curved.x, on_facets, held).changed);
  EXPECT_EQ(crossings(apart), 0);
}

TEST(UntangleTest, WithFacetsThatDoNotIntersectSuccessIsCertain) {
  const Sheet linear_positions = strip(0), curved = strip(6e-3);
  ASSERT_EQ(crossings(linear_positions), 0);
  ASSERT_GT(crossings(curved), 50);
  Sheet apart = curved;
  const std::vector<char> held(apart.x.rows(), 0);
  const Untangler::Outcome outcome =
      Untangler(apart.pattern, apart.triangles)(apart.x, linear_positions.x, {}, held);
  EXPECT_TRUE(outcome.changed && outcome.apart());
  EXPECT_EQ(crossings(apart), 0);
}

TEST(UntangleTest, AlternatingRoundsGiveBetterLengthsThanOneRound) {
  const Sheet linear_positions = strip(0), curved = strip(1.5e-3);
  const std::vector<char> held(linear_positions.x.rows(), 0);
  const Untangler layers(linear_positions.pattern, linear_positions.triangles);
  const StrainLimit limit(linear_positions.pattern, linear_positions.triangles, {0.002, 60});
  Points3 once = curved.x, turns = curved.x;
  layers(once, linear_positions.x, {}, held);
  ASSERT_GT(limit.worst(once), 0.004);
  EXPECT_TRUE(layers
                  .untangle_alternating(turns, linear_positions.x,
                                        {[&](Points3& x) { limit(x, held); },
                                         [&](const Points3& x) { return limit.worst(x); }},
                                        held)
                  .apart());
  EXPECT_EQ(crossings(Sheet{linear_positions.pattern, turns, {}, linear_positions.triangles, {}}),
            0);
  EXPECT_LT(limit.worst(turns), limit.worst(once));
}

TEST(UntangleTest, ReportsThatIntersectingFacetsCannotBeSeparated) {
  Sheet curved = strip(0.8e-3);
  const std::vector<char> held(curved.x.rows(), 0);
  const Points3 linear_positions = curved.x;
  EXPECT_FALSE(
      Untangler(curved.pattern, curved.triangles)(curved.x, linear_positions, {}, held).apart());
}

TEST(UntangleTest, ARollMayMeetItselfIfItsEndsAreNearerThanTheSurfaceIsOff) {
  Sheet sheet = test::hex_sheet(0.1, 0.05, 12);
  const double radius = 0.1 / 6.0;  // 6 of 6.28 rad: the ends are 4.7 mm apart
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x.row(v) << radius * std::sin(sheet.pattern(v, 0) / radius), sheet.pattern(v, 1),
        radius * (1 - std::cos(sheet.pattern(v, 0) / radius));
  const auto off = [&](double all) {
    return Eigen::VectorXd(Eigen::VectorXd::Constant(sheet.triangles.rows(), all));
  };
  EXPECT_FALSE(may_meet_itself(sheet, off(1e-3)));
  EXPECT_TRUE(may_meet_itself(sheet, off(3e-3)));
}

// Tests of the tree of triangles.

/// How many of these pairs of triangles pass through each other.
int crossings_among(const std::vector<std::pair<int, int>>& pairs, const Points3& x,
                    const Triangles& triangles) {
  return static_cast<int>(std::count_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
    Triangles two(2, 3);
    two << triangles.row(pair.first), triangles.row(pair.second);
    return crossings(Sheet{{}, x, {}, two, {}}) > 0;
  }));
}

TEST(UntangleTest, TheTreeFindsAllPairsOfLayersAndNearlyAllPairsOfNoise) {
  std::mt19937 random(1);
  for (int k = 0; k < 6; ++k) {
    Sheet sheet = k < 2 ? strip(0.7e-3 + 1e-3 * k) : test::hex_sheet(0.1, 0.1, 14, 0.2, k);
    std::normal_distribution<double> noise(0, k < 2 ? 1e-4 : 6e-3);
    for (int v = 0; v < sheet.x.rows(); ++v) {
      sheet.x(v, 2) += noise(random);
      sheet.x(v, 0) += noise(random);
    }
    const int all = crossings(sheet);
    ASSERT_GT(all, 10) << k;
    const NormalConeTree tree(sheet.pattern, sheet.triangles);
    const int found = crossings_among(tree.near(sheet.x, sheet.x), sheet.x, sheet.triangles);
    EXPECT_LE(found, all) << k;
    EXPECT_GE(found, k < 2 ? all : 0.95 * all) << k;
  }
}

TEST(UntangleTest, TheTreeFindsPairsThatIntersectOnTheWay) {
  const Sheet from = strip(0.2e-3);
  Points3 to = from.x, middle;
  for (int v = 0; v < to.rows(); ++v)
    if (from.pattern(v, 0) > leg + 5e-3) to(v, 2) -= 4 * gap;
  middle = 0.5 * (from.x + to);
  const int between = crossings(Sheet{from.pattern, middle, {}, from.triangles, {}});
  ASSERT_GT(between, 3);
  const NormalConeTree tree(from.pattern, from.triangles);
  EXPECT_EQ(crossings_among(tree.near(from.x, to), middle, from.triangles), between);
}

TEST(UntangleTest, TheTreeFindsNoPairInAGentlyBentSheet) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20, 0.2);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 0.01 * std::sin(40 * sheet.pattern(v, 0));
  EXPECT_TRUE(NormalConeTree(sheet.pattern, sheet.triangles).near(sheet.x, sheet.x).empty());
}

/// A ring without a sixteenth, rolled to a cone so wide that its ends lie over each other, one
/// turning up by `tilt` [1] and the other down. All its normals lie in one half-space, and no two
/// triangles are folded sharply.
Sheet wide_cone(double tilt) {
  constexpr int turns = 180, rings = 8;
  constexpr double inner = 0.03, outer = 0.1, rise = 2e-3, angle = 1.9375 * M_PI;
  const double slope = M_PI / 3;  // of the generators against the axis
  Sheet sheet;
  sheet.pattern.resize((turns + 1) * (rings + 1), 2);
  sheet.x.resize(sheet.pattern.rows(), 3);
  sheet.triangles.resize(2 * turns * rings, 3);
  for (int i = 0, v = 0, t = 0; i <= turns; ++i)
    for (int j = 0; j <= rings; ++j, ++v) {
      const double way = double(i) / turns, r = inner + (outer - inner) * j / rings,
                   phi = angle * way / std::sin(slope);
      sheet.pattern.row(v) << r * std::cos(angle * way), r * std::sin(angle * way);
      sheet.x.row(v) << r * std::sin(slope) * std::cos(phi), r * std::sin(slope) * std::sin(phi),
          -r * std::cos(slope) + (way - 0.5) * (rise - tilt * (r - inner));
      if (i == turns || j == rings) continue;
      sheet.triangles.row(t++) << v, v + 1, v + rings + 2;
      sheet.triangles.row(t++) << v, v + rings + 2, v + rings + 1;
    }
  return sheet;
}

TEST(UntangleTest, EndsOfAWideConeThatPassThroughEachOtherAreSeparated) {
  const Sheet flat = wide_cone(0);
  ASSERT_EQ(crossings(flat), 0);
  Sheet curved = wide_cone(0.1);
  ASSERT_GT(crossings(curved), 10);
  const std::vector<char> held(curved.x.rows(), 0);
  const Untangler::Outcome outcome =
      Untangler(curved.pattern, curved.triangles)(curved.x, flat.x, {}, held);
  EXPECT_TRUE(outcome.changed && outcome.apart());
  EXPECT_EQ(crossings(curved), 0);
}

}  // namespace
}  // namespace paperbake
