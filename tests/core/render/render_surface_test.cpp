#include "core/render/render_surface.h"

#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"
#include "core/render/shot_record.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace paperbake {
namespace {

constexpr double R = 0.03;

/// A coarse roll whose edges across the rulings have their true lengths, as in a simulated sheet:
/// they are chords as long as on the pattern.
Sheet coarse_roll() {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  test::roll(sheet, R);
  return sheet;
}

struct Rendered {
  RenderSurface render;
  RenderFrame frame;
};
Rendered rendered(const Sheet& sheet, Quality quality, const RenderFeatures& features = {},
                  const std::vector<int>& held = {}, const Points3& at = Points3(0, 3)) {
  RenderSurface render = make_render_surface(test::rectangle(0.1, 0.1), features, 0.01, quality);
  render.hold(held);
  RenderFrame frame = render.frame(sheet, render.locate_on(sheet.pattern, sheet.triangles), at);
  return {std::move(render), std::move(frame)};
}

/// Mean angle between the normals and those of the roll, at vertices at least 5 mm inside. [deg]
double normals_off(const Rendered& r) {
  double sum = 0, count = 0;
  const Points2& pattern = r.render.mesh().pattern;
  for (int v = 0; v < pattern.rows(); ++v) {
    if (pattern.row(v).minCoeff() < 0.005 || pattern.row(v).maxCoeff() > 0.095) continue;
    const double a = pattern(v, 0) / R;
    sum +=
        std::acos(std::min(1.0, Vector3d(std::sin(a), 0, std::cos(a)).dot(r.frame.normals.row(v))));
    count += 1;
  }
  return sum / count * 180 / M_PI;
}

TEST(RenderSurfaceTest, AStripHasEightEdgesAcrossInAShot) {
  const RenderSurface strip =
      make_render_surface(test::rectangle(0.5, 0.01), {}, 0.01, Quality::shot);
  const Points2& pattern = strip.mesh().pattern;
  std::set<long> rows;
  for (int v = 0; v < pattern.rows(); ++v)
    if (pattern(v, 0) == 0) rows.insert(std::lround(1e6 * pattern(v, 1)));
  EXPECT_GE(rows.size(), 8u);
  EXPECT_LE(rows.size(), 11u);
}

TEST(RenderSurfaceTest, ShowsACoarseRollAsASmoothRoll) {
  const Sheet sheet = coarse_roll();
  // mean over a flat facet of 10 mm: 4.8 degrees
  const double flat_facet = 180 / M_PI * 0.01 / R / 4;
  for (const Quality quality : {Quality::shot, Quality::hero}) {
    const Rendered r = rendered(sheet, quality);
    EXPECT_LT(normals_off(r), 0.15 * flat_facet);
    const LengthDistortion d =
        length_distortion({r.render.mesh().pattern, r.frame.x, {}, r.render.mesh().triangles, {}});
    EXPECT_LT(d.mean, 0.001);
  }
}

TEST(RenderSurfaceTest, StaysWithinTheChordErrorOfTheSimulatedSheet) {
  const Sheet sheet = coarse_roll();
  const Rendered r = rendered(sheet, Quality::shot);
  const auto places = r.render.locate_on(sheet.pattern, sheet.triangles);
  double most = 0;
  for (std::size_t v = 0; v < places.size(); ++v)
    most = std::max(
        most,
        (interpolate(places[v], sheet.triangles, sheet.x) - r.frame.x.row(v).transpose()).norm());
  const double sagitta = 0.01 * 0.01 / (8 * R);
  EXPECT_GT(most, 0.5 * sagitta);
  // plus what the lengths of the arc need and the chords did not have
  EXPECT_LT(most, 1.5 * sagitta);
}

/// The middle of an edge, too, which hero adds: halfway between its ends it would lie under a bend.
TEST(RenderSurfaceTest, EveryVertexHasItsPlaceOnTheFlatTrianglesOfTheSimulatedSheet) {
  const Sheet sheet = coarse_roll();
  const PointLocator locator(sheet.pattern, sheet.triangles);
  for (const Quality quality : {Quality::shot, Quality::hero}) {
    const Rendered r = rendered(sheet, quality);
    const Points2& pattern = r.render.mesh().pattern;
    const auto places = r.render.locate_on(sheet.pattern, sheet.triangles);
    ASSERT_EQ(static_cast<Eigen::Index>(places.size()), pattern.rows());
    const Points3 linear = r.render.linear_positions(sheet, places);
    for (int v = 0; v < pattern.rows(); ++v) {
      if (pattern.row(v).minCoeff() < 0.005 || pattern.row(v).maxCoeff() > 0.095) continue;
      const Vector3d on_triangle =
          interpolate(locator.locate(pattern.row(v)), sheet.triangles, sheet.x);
      ASSERT_LT((linear.row(v).transpose() - on_triangle).norm(), 1e-9) << v;
    }
  }
}

TEST(RenderSurfaceTest, HandlesAreWhereTheyAreHeld) {
  const Sheet sheet = coarse_roll();
  const RenderFeatures features{{{0, 0}, {0.05, 0.05}, {0.1, 0.03}}, {}};
  Points3 at(2, 3);
  at << -0.001, 0.0003, 0.0002, 0.07, 0.03, -0.04;
  const Rendered r = rendered(sheet, Quality::hero, features, {0, 2}, at);
  for (int k = 0; k < 2; ++k)
    EXPECT_EQ(Vector3d(r.frame.x.row(r.render.mesh().point_vertex[k == 0 ? 0 : 2])),
              Vector3d(at.row(k)));
}

TEST(RenderSurfaceTest, GivesTheSameFrameTwice) {
  const Sheet sheet = coarse_roll();
  const Rendered a = rendered(sheet, Quality::hero), b = rendered(sheet, Quality::hero);
  EXPECT_EQ(a.frame.x, b.frame.x);
  EXPECT_EQ(a.frame.normals, b.frame.normals);
}

TEST(RenderSurfaceTest, AShotRecordKeepsEachMeshOnceAndTheFeaturesOfTheShot) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 10);
  const auto fold = [&](double angle) {  // along y = 0.05 of the pattern
    for (int v = 0; v < sheet.x.rows(); ++v) {
      const double s = std::max(0.0, sheet.pattern(v, 1) - sheet.pattern(60, 1));
      sheet.x.row(v) << sheet.pattern(v, 0), sheet.pattern(v, 1) - s + s * std::cos(angle),
          -s * std::sin(angle);
    }
  };
  Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
  shot.handles.push_back(test::bare_handle("handle", {0.02, 0.1}, 8));
  ShotRecord record;
  for (int f = 1; f <= 8; ++f) {
    fold(f < 4 ? 0.1 : 1.0);
    if (f == 6) sheet.singular.push_back({{0.03, 0.04}, 6, "test"});
    AnimatedFrame frame;
    frame.frame = f;
    frame.sheet = &sheet;
    frame.handles.resize(1);
    frame.handles[0].state = f < 3 ? HandleFrame::free : HandleFrame::held;
    frame.handles[0].at = {0.1, 0.2, 0.3};
    record.add(frame);
  }
  EXPECT_EQ(record.meshes().size(), 1u);
  ASSERT_EQ(record.frames().size(), 8u);
  EXPECT_TRUE(record.frames()[1].held.empty());
  EXPECT_EQ(record.frames()[2].held, std::vector<int>{0});
  EXPECT_EQ(Vector3d(record.frames()[2].held_at.row(0)), Vector3d(0.1, 0.2, 0.3));
  // positions are recorded in 32 bits
  EXPECT_LT((record.sheet(record.frames()[7]).x - sheet.x).cwiseAbs().maxCoeff(), 1e-8);
  const RenderFeatures features = record.features(shot);
  EXPECT_EQ(features.points.front(), Vector2d(0.02, 0.1));
  EXPECT_EQ(features.points.back(), Vector2d(0.03, 0.04));
  double length = 0;
  for (const CreaseSegment& c : features.creases) length += (c.b - c.a).norm();
  EXPECT_NEAR(length, 0.1, 1e-9) << "the fold, and nothing else";
}

TEST(RenderSurfaceTest, OnlyWhatBreaksFoldsBeginsSharpOrTouchesMayBeCreased) {
  const Sheet flat = test::hex_sheet(0.1, 0.1, 10);
  Sheet sharp = flat;
  for (int v = 0; v < flat.x.rows(); ++v)
    if (const double s = flat.pattern(v, 0) - 0.05; s > 0)
      sharp.x.row(v) << 0.05, flat.pattern(v, 1), s;
  const auto record_of = [](const Sheet& first, const Sheet& then, int on_colliders) {
    ShotRecord record;
    for (int f = 1; f <= 2; ++f) {
      AnimatedFrame frame;
      frame.frame = f;
      frame.sheet = f == 1 ? &first : &then;
      frame.statistics.on_colliders = on_colliders;
      record.add(frame);
    }
    return record;
  };
  EXPECT_FALSE(record_of(flat, sharp, 0).may_be_creased()) << "its mesh is coarse";
  EXPECT_TRUE(record_of(sharp, flat, 0).may_be_creased());
  EXPECT_TRUE(record_of(flat, sharp, 1).may_be_creased());
  Sheet broken = flat;
  broken.singular.push_back({{0.03, 0.04}, 2, "test"});
  EXPECT_TRUE(record_of(flat, broken, 0).may_be_creased());
}

}  // namespace
}  // namespace paperbake
