#include "core/animation/initial_sheet.h"

#include "core/animation/animate.h"
#include "core/geometry/measure.h"
#include "core/methods/adaptive.h"
#include "core/step1_elastic/elastic.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

constexpr int cap = 3000;

MethodChoice adaptive_of(const Shot& shot, int most = cap, const SizingOptions& options = {}) {
  return adaptive(shot.pattern, most, options);
}

std::vector<Sheet> play(const Shot& shot, const MethodChoice& method, int last_frame,
                        Plasticity plasticity = Plasticity::off) {
  AnimateOptions options;
  options.last_frame = last_frame;
  options.plasticity = plasticity;
  std::vector<Sheet> sheets;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    sheets.push_back(*frame.sheet);
    for (const HandleFrame& handle : frame.handles)
      if (handle.state == HandleFrame::held) {
        EXPECT_LT((handle.at - handle.keyed).norm(), 1e-4) << frame.frame;
      }
    return true;
  });
  return sheets;
}

TEST(AdaptiveTest, AnArchIsTheElasticaOnFewTrianglesAndASoundMesh) {
  const Shot shot = test::s1_push();
  const std::vector<Sheet> sheets = play(shot, adaptive_of(shot), 24);
  for (const Sheet& sheet : sheets) test::expect_sound(sheet, 0.01);
  EXPECT_LT(sheets.back().triangles.rows(), 250);
  EXPECT_GT(sheets.back().triangles.rows(), sheets.front().triangles.rows());
  // the arch is a polygon of a dozen facets that turn by a quarter of a radian
  EXPECT_NEAR(sheets.back().x.col(2).maxCoeff() / 0.019492, 1, 0.02);
  EXPECT_LT(length_distortion(sheets.back()).mean, 1e-4);
}

TEST(AdaptiveTest, TheSameSeedGivesTheSameSheetToTheLastBit) {
  const Shot shot = test::s1_push();
  const Sheet a = play(shot, adaptive_of(shot), 16).back(),
              b = play(shot, adaptive_of(shot), 16).back();
  ASSERT_GT(a.x.col(2).maxCoeff(), 0.01);
  EXPECT_TRUE(a.triangles == b.triangles);
  EXPECT_TRUE(a.x == b.x);
}

TEST(AdaptiveTest, ASheetThatStaysFlatStaysCoarse) {
  Shot shot = test::blank_shot(test::rectangle(0.2, 0.2));
  for (const double x : {0.0, 0.2}) {  // carried through space
    Handle handle = test::bare_handle("h" + std::to_string(shot.handles.size()), {x, 0.1}, 12);
    for (int f = 0; f < 12; ++f) handle.keyed(f, 2) += 0.01 * f;
    shot.handles.push_back(handle);
  }
  const std::vector<Sheet> sheets = play(shot, adaptive_of(shot), 12);
  EXPECT_NEAR(sheets.back().x.col(2).mean(), 0.11, 1e-3);
  EXPECT_LT(sheets.back().triangles.rows(), 80);  // edges of up to a quarter of the side
}

TEST(AdaptiveTest, AFlatSheetUnderCompressionIsNotRefinedWithoutEnd) {
  // Both borders are pushed together by 3 % in the plane, without an initial arch: the reference
  // went to 9,724 triangles in a frame.
  Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
  for (int i = 0; i <= 4; ++i)
    for (const double side : {0.0, 0.1}) {
      Handle handle =
          test::bare_handle("h" + std::to_string(shot.handles.size()), {side, 0.025 * i}, 24);
      for (int f = 0; side > 0 && f < 24; ++f) handle.keyed(f, 0) -= 0.003 * std::min(1.0, f / 4.0);
      shot.handles.push_back(handle);
    }
  long most = 0;
  const std::vector<Sheet> sheets = play(shot, adaptive_of(shot), 24);
  for (const Sheet& sheet : sheets) most = std::max<long>(most, sheet.triangles.rows());
  EXPECT_LT(most, 400);
  // it has buckled
  EXPECT_GT(sheets.back().x.col(2).maxCoeff() - sheets.back().x.col(2).minCoeff(), 0.005);
}

TEST(AdaptiveTest, ASecondAfterAJumpThereAreAsManyTrianglesAsAfterSlowMotion) {
  const auto pushed = [](int frames) {  // the push of S1 in so many frames, then rest
    Shot shot = test::s1_push();
    shot.handles.pop_back();
    for (Handle& handle : shot.handles) {
      const Points3 slow = handle.keyed;
      for (int f = 0; f < handle.keyed.rows(); ++f)
        handle.keyed.row(f) = slow.row(std::min(23, f * 23 / frames));
    }
    return shot;
  };
  const Shot slow = pushed(23), fast = pushed(1);
  const std::vector<Sheet> a = play(slow, adaptive_of(slow), 48),
                           b = play(fast, adaptive_of(fast), 26);
  ASSERT_GT(b.back().x.col(2).maxCoeff(), 0.015);
  EXPECT_LT(b.back().triangles.rows(), 1.5 * a.back().triangles.rows());
  EXPECT_GT(b.back().triangles.rows(), a.back().triangles.rows() / 1.5);
}

TEST(AdaptiveTest, AMovingShapeIsNotRefinedAndAJumpIsTakenOnFewTriangles) {
  const Shot shot = test::s1_push();
  SizingOptions fine;
  fine.edge_turn = 0.05;
  Sheet arch = play(shot, adaptive_of(shot, cap, fine), 24).back();
  ASSERT_GT(arch.triangles.rows(), 600);
  const std::vector<char> fixed =
      make_initial_sheet(shot, *adaptive_of(shot, cap, fine).make(), 0).fixed;
  const auto triangles_after = [&](const SizingOptions& options, bool at_minimum,
                                   double relative_handle_motion) {
    Sheet sheet = arch;
    RemeshContext context(fixed);
    context.now = {25, 1 / 24.0};
    context.moving = true;
    context.at_minimum = at_minimum;
    context.relative_handle_motion = relative_handle_motion;
    adaptive_of(shot, cap, options).make()->remesh(sheet, context);
    return sheet.triangles.rows();
  };
  SizingOptions finer = fine;
  finer.edge_turn = 0.03;
  EXPECT_GT(triangles_after(finer, true, 0), 1.2 * arch.triangles.rows());
  EXPECT_EQ(triangles_after(finer, false, 0), arch.triangles.rows());
  EXPECT_LT(triangles_after(finer, false, 0.5), 0.9 * arch.triangles.rows());
}

TEST(AdaptiveTest, AtRestTheMeshStaysAndCostsNothing) {
  Shot shot = test::s1_push();
  shot.handles.pop_back();
  for (Handle& handle : shot.handles)
    for (int f = 12; f < handle.keyed.rows(); ++f) handle.keyed.row(f) = handle.keyed.row(11);
  const std::vector<Sheet> sheets = play(shot, adaptive_of(shot), 40);
  ASSERT_GT(sheets.back().x.col(2).maxCoeff(), 0.01);
  for (std::size_t f = 30; f < sheets.size(); ++f)
    EXPECT_TRUE(sheets[f].x.rows() == sheets[29].x.rows() && sheets[f].x == sheets[29].x) << f;
}

TEST(AdaptiveTest, TheTriangleLimitCoarsensTheWholeField) {
  const Shot shot = test::s1_push();
  SizingOptions fine;
  fine.edge_turn = 0.03;
  fine.largest = 0.1;
  const Sheet sheet = play(shot, adaptive_of(shot, 400, fine), 20).back();
  EXPECT_LE(sheet.triangles.rows(), 400);
  EXPECT_GT(sheet.triangles.rows(), 200);
  int left = 0;  // the arch is symmetric about its crest, and so is the mesh, more or less
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    left += (sheet.pattern(sheet.triangles(t, 0), 0) + sheet.pattern(sheet.triangles(t, 1), 0) +
             sheet.pattern(sheet.triangles(t, 2), 0)) /
                3 <
            0.05;
  EXPECT_NEAR(left / double(sheet.triangles.rows()), 0.5, 0.1);
}

TEST(AdaptiveTest, AChangeOfMeshMostlyDoesNotRaiseTheEnergy) {
  const Shot shot = test::s1_push();
  const MethodChoice method = adaptive_of(shot);
  AnimateOptions options;
  options.last_frame = 40;
  const std::vector<char> fixed = make_initial_sheet(shot, *method.make(), 0).fixed;
  const auto at_rest = [&](Sheet& sheet) {  // [J] with both borders held where they are
    PositionConstraints held;
    for (int v = 0; v < static_cast<int>(fixed.size()); ++v)
      if (fixed[v] && (sheet.pattern(v, 0) == 0 || sheet.pattern(v, 0) == 0.1))
        held.push_back({v, sheet.x.row(v)});
    Elastic elastic(shot.paper, {});
    elastic.set_mesh(sheet);
    return elastic.relax(sheet, {held}, 1 / 24.0, Relaxation::full).energy;
  };
  std::vector<double> rises;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    Sheet before = *frame.sheet, after = *frame.sheet;
    // before frame 4 it is buckling to a side; after frame 24 it is also pushed from above
    if (frame.frame < 4 || frame.frame > 24) return true;
    RemeshContext context(fixed);
    context.now = {frame.frame, 1 / 24.0};
    context.moving = context.at_minimum = true;
    if (method.make()->remesh(after, context) == MeshChange::none) return true;
    const double was = at_rest(before);
    rises.push_back(at_rest(after) / was - 1);
    return true;
  });
  ASSERT_GT(rises.size(), 5u);
  std::sort(rises.begin(), rises.end());
  EXPECT_LT(rises[rises.size() / 2], 0.01);
  // on a hundred triangles one diagonal flipped the wrong way costs this much, for a frame or two
  EXPECT_LT(rises.back(), 0.2);
}

}  // namespace
}  // namespace paperbake
