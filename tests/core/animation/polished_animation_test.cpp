#include "core/animation/polished_animation.h"

#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/core/collider_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <map>

namespace paperbake {
namespace {

PolishOptions triangles(int n, int threads = 1) {
  PolishOptions options;
  options.triangles = n;
  options.threads = threads;
  return options;
}

struct Frame {
  AnimatedFrame frame;
  Sheet sheet;
};

AnimateOptions until(int frame) {
  AnimateOptions options;
  options.last_frame = frame;
  return options;
}
MethodChoice coarse(const Shot& shot, int base_triangles = 90) {
  return hybrid(shot.pattern, shot.paper, base_triangles, {}, 0, 0);
}

std::map<int, Frame> polished(const Shot& shot, int last, const PolishOptions& how,
                              int base_triangles = 90) {
  std::map<int, Frame> frames;
  animate_polished(shot, coarse(shot, base_triangles), until(last), how,
                   [&](const AnimatedFrame& f) {
                     EXPECT_FALSE(f.state) << "the simulation of this frame has gone on";
                     frames[f.frame] = {f, *f.sheet};
                     return true;
                   });
  return frames;
}
std::map<int, Frame> marched(const Shot& shot, const MethodChoice& method, int last) {
  std::map<int, Frame> frames;
  animate(shot, method, until(last), [&](const AnimatedFrame& f) {
    frames[f.frame] = {f, *f.sheet};
    return true;
  });
  return frames;
}

TEST(RefinedAnimationTest, HasTheEnergyOfAFullRunOfFineFem) {
  const Shot shot = test::s1_push();
  const auto ours = polished(shot, 30, triangles(1000)), fine = marched(shot, fem(1000), 30),
             rough = marched(shot, coarse(shot), 30);
  ASSERT_EQ(ours.size(), 30u);
  for (const int f : {6, 12, 24, 30}) {
    EXPECT_NEAR(ours.at(f).frame.statistics.energy, fine.at(f).frame.statistics.energy,
                2e-3 * fine.at(f).frame.statistics.energy)
        << f;
    EXPECT_GT(ours.at(f).sheet.triangles.rows(), 800) << f;
    EXPECT_LT(length_distortion(ours.at(f).sheet).mean, 1e-4) << f;
    EXPECT_GT(ours.at(f).frame.statistics.newton_iterations,
              rough.at(f).frame.statistics.newton_iterations)
        << f;
  }
}

TEST(RefinedAnimationTest, AFrameIsTheSameAloneAndWithAnyNumberOfThreads) {
  const Shot shot = test::s1_push();
  const auto all = polished(shot, 28, triangles(400)),
             threads = polished(shot, 28, triangles(400, 3));
  PolishOptions alone = triangles(400);
  alone.wanted = [](int frame) { return frame == 26; };
  const auto one = polished(shot, 28, alone);
  ASSERT_EQ(threads.size(), all.size());
  for (const auto& [f, frame] : all) EXPECT_TRUE(threads.at(f).sheet.x == frame.sheet.x) << f;
  EXPECT_TRUE(one.at(26).sheet.x == all.at(26).sheet.x);
  // as the method left it
  EXPECT_LT(one.at(25).sheet.triangles.rows(), all.at(25).sheet.triangles.rows());
}

/// The middle handle is relative: it holds the sheet where the sheet is, and the polished sheet is
/// elsewhere.
TEST(RefinedAnimationTest, ARelativeHandleHoldsThePolishedSheetWhereItTookHold) {
  const Shot shot = test::s1_push();
  const auto frames = polished(shot, 28, triangles(400));
  const std::size_t mid = shot.handles.size() - 1;
  const auto at = [&](int f) { return frames.at(f).frame.handles[mid]; };
  ASSERT_EQ(at(23).state, HandleFrame::free);
  ASSERT_EQ(at(24).state, HandleFrame::held);
  for (int f = 25; f <= 28; ++f) {
    const Vector3d way =
        (shot.handles[mid].keyed.row(f - 1) - shot.handles[mid].keyed.row(23)).transpose();
    EXPECT_LT((at(f).at - at(24).at - way).norm(), 1e-12) << f;
    EXPECT_LT((at(f).keyed - at(f).at).norm(), 1e-12) << f;
  }
  const auto rough = marched(shot, coarse(shot), 28);
  EXPECT_GT((rough.at(28).frame.handles[mid].at - at(28).at).norm(), 1e-6);
}

TEST(RefinedAnimationTest, ASheetThatTouchesItselfIsHandedOnUnpolishedWithANote) {
  // the ends of the sheet are brought together, one is pressed against the other
  Shot shot = test::blank_shot(test::rectangle(0.1, 0.05));
  constexpr int last = 24;
  for (int i = 0; i <= 4; ++i)
    for (const double end : {0.0, 0.1}) {
      Handle handle = test::bare_handle("handle", {end, 0.0125 * i}, last);
      for (int f = 0; f < last; ++f) {
        const double t = f / (last - 1.0);
        if (end > 0)
          handle.keyed.row(f) << 0.1 - 0.101 * t, 0.0125 * i,
              0.02 * std::sin(M_PI * t) + 0.0002 * t;
      }
      shot.handles.push_back(handle);
    }
  const auto frames = polished(shot, last, triangles(300)),
             rough = marched(shot, coarse(shot), last);
  int touching = 0;
  for (const auto& [f, frame] : frames) {
    if (rough.at(f).frame.statistics.touching == 0) continue;
    ++touching;
    EXPECT_NE(frame.frame.note.find("not polished"), std::string::npos) << f;
    EXPECT_TRUE(frame.sheet.x == rough.at(f).sheet.x) << f;
  }
  EXPECT_GT(touching, 0);
}

/// The polished arch is higher than the coarse one, and a peg stands in its way that the coarse one
/// does not reach.
TEST(RefinedAnimationTest, ASheetThatEndsInsideAColliderIsHandedOnUnpolishedWithANote) {
  Shot shot = test::s1_push();
  constexpr int last = 24, base = 12;
  const PolishOptions how = triangles(400);
  const Sheet fine = polished(shot, last, how, base).at(last).sheet,
              low = marched(shot, coarse(shot, base), last).at(last).sheet;
  const PointLocator locator(low.pattern, low.triangles);
  Vector3d top(0, 0, 0);
  double higher = 0;
  for (int v = 0; v < fine.x.rows(); ++v)
    if (const double by = fine.x(v, 2) -
                          interpolate(locator.locate(fine.pattern.row(v)), low.triangles, low.x)[2];
        by > higher) {
      higher = by;
      top = fine.x.row(v);
    }
  ASSERT_GT(higher, 7e-4) << "the coarse sheet feels the peg";
  shot.colliders =
      test::all({test::box(top - Vector3d(1e-4, 1e-4, 5e-5), top + Vector3d(1e-4, 1e-4, 0.02))});
  const auto frames = polished(shot, last, how, base),
             rough = marched(shot, coarse(shot, base), last);
  ASSERT_EQ(rough.at(last).frame.statistics.on_colliders, 0);
  ASSERT_NE(frames.at(last).frame.note.find("inside a collider"), std::string::npos);
  EXPECT_TRUE(frames.at(last).sheet.x == rough.at(last).sheet.x);
  EXPECT_EQ(frames.at(12).frame.note.find("not polished"), std::string::npos);
}

}  // namespace
}  // namespace paperbake
