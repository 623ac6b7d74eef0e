#include "core/render/untangle_sheets.h"
#include "core/geometry/intersections.h"

#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

constexpr double height = 0.05, half = M_PI / 6;  // [m], [rad] half the angle of the fold

/// A sheet of four triangles, folded sharply at the distance `fold` from its left border, with the
/// bottom of the fold at z = `up`. [m]
Sheet folded(double width, double fold, double up) {
  Sheet sheet;
  sheet.pattern.resize(6, 2);
  sheet.pattern << 0, 0, fold, 0, width, 0, 0, height, fold, height, width, height;
  sheet.triangles.resize(4, 3);
  sheet.triangles << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4;
  sheet.x.resize(6, 3);
  for (int v = 0; v < 6; ++v) {
    const double s = sheet.pattern(v, 0) - fold;
    sheet.x.row(v) << s * std::sin(half), sheet.pattern(v, 1), std::abs(s) * std::cos(half) + up;
  }
  return sheet;
}

/// Two such sheets, one in the other; their render meshes have nothing in common.
struct Nested {
  std::vector<Sheet> sheets;
  std::vector<RenderSurface> renders;
  std::vector<std::vector<MeshPoint>> places;
  std::vector<SheetUntangler::Simulated> simulated;
  std::vector<RenderFrame> frames;

  enum class Edges { none, all };
  Nested(double gap, Edges edges) : sheets{folded(0.1, 0.05, 0), folded(0.0973, 0.0471, gap)} {
    for (const Sheet& sheet : sheets) {
      RenderFeatures features;
      if (edges == Edges::all)
        for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
          features.edges.push_back(
              {sheet.pattern.row(hinge.vertices[0]), sheet.pattern.row(hinge.vertices[1])});
      renders.push_back(make_render_surface(test::rectangle(sheet.pattern(2, 0), height), features,
                                            0.05, Quality::draft));
      renders.back().hold({});
      places.push_back(renders.back().locate_on(sheet.pattern, sheet.triangles));
    }
    for (std::size_t s = 0; s < 2; ++s) {
      simulated.push_back({sheets[s], &places[s]});
      frames.push_back(renders[s].frame(sheets[s], places[s], Points3(0, 3)));
    }
  }
  std::vector<Points3> positions() const { return {frames[0].x, frames[1].x}; }
};

TEST(UntangleSheetsTest, FacetsIntersectOnlyOnMeshesWithoutTheSimulatedEdges) {
  const double gap = 0.1e-3;
  const Nested without(gap, Nested::Edges::none), with(gap, Nested::Edges::all);
  ASSERT_EQ(crossings_between(without.sheets[0], without.sheets[1]), 0);
  EXPECT_TRUE(SheetUntangler(without.renders).linear_surfaces_intersect(without.simulated));
  EXPECT_FALSE(SheetUntangler(with.renders).linear_surfaces_intersect(with.simulated));
}

TEST(UntangleSheetsTest, ASheetThatBulgesThroughAnotherGoesBackAndBothKeepTheirLengths) {
  Nested nested(0.1e-3, Nested::Edges::all);
  for (int v = 0; v < nested.frames[0].x.rows(); ++v)
    nested.frames[0].x(v, 2) +=
        0.5e-3 * std::sin(M_PI * nested.renders[0].mesh().pattern(v, 0) / 0.1);
  const SheetUntangler together(nested.renders);
  ASSERT_GT(together.crossings(nested.positions())[1], 10);
  together.keep_apart(nested.frames, nested.simulated);
  EXPECT_EQ(together.crossings(nested.positions()), (std::vector<int>{0, 0}));
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(nested.renders[s].crossings(nested.frames[s].x), 0);
    EXPECT_LT(nested.renders[s].worst_edge(nested.frames[s].x), 0.025);
  }
  EXPECT_TRUE(nested.frames[0].kept_apart);
}

// Normals of two pages that lie on each other are as alike as those of one sheet that cannot meet
// itself.
TEST(UntangleSheetsTest, PagesThatLieOnEachOtherAreSeparated) {
  std::vector<RenderSurface> renders;
  std::vector<SheetUntangler::Simulated> simulated;
  std::vector<RenderFrame> frames;
  std::vector<std::vector<MeshPoint>> places(2);
  for (int s = 0; s < 2; ++s) {
    const double width = s == 0 ? 0.1 : 0.0973;  // their render meshes have nothing in common
    Sheet page = folded(width, 0.05, 0);
    page.x.leftCols<2>() = page.pattern;
    page.x.col(2).setConstant(0.2e-3 * s);
    renders.push_back(
        make_render_surface(test::rectangle(width, height), {}, 0.05, Quality::draft));
    renders.back().hold({});
    places[s] = renders.back().locate_on(page.pattern, page.triangles);
    frames.push_back(renders.back().frame(page, places[s], Points3(0, 3)));
    simulated.push_back({std::move(page), &places[s]});
  }
  for (int v = 0; v < frames[0].x.rows(); ++v)
    frames[0].x(v, 2) += 0.5e-3 * std::sin(M_PI * renders[0].mesh().pattern(v, 0) / 0.1);
  const SheetUntangler together(renders);
  ASSERT_GT(together.crossings({frames[0].x, frames[1].x})[1], 10);
  together.keep_apart(frames, simulated);
  EXPECT_EQ(together.crossings({frames[0].x, frames[1].x}), (std::vector<int>{0, 0}));
}

TEST(UntangleSheetsTest, SheetsThatDoNotIntersectAreNotMoved) {
  Nested nested(0.02, Nested::Edges::none);
  const std::vector<Points3> before = nested.positions();
  const SheetUntangler together(nested.renders);
  ASSERT_EQ(together.crossings(before), (std::vector<int>{0, 0}));
  together.keep_apart(nested.frames, nested.simulated);
  EXPECT_EQ(nested.positions(), before);
  EXPECT_FALSE(nested.frames[0].kept_apart || nested.frames[1].kept_apart);
}

}  // namespace
}  // namespace paperbake
