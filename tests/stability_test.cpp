// What handles do that no artist should key: it ends, it is finite, it is reported.

#include "core/animate.h"
#include "core/measure.h"
#include "core/pattern_samples.h"
#include "tests/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

struct Ended {
  Sheet sheet;
  std::vector<HandleFrame> handles;
  double worst_edge = 0;
  int frames = 0, crossed = 0;
};

Ended play(const Shot& shot, int frames, const std::function<Method(const Shot&)>& method) {
  AnimateOptions options;
  options.last_frame = frames;
  options.memory = Memory::plastic;
  Ended ended;
  animate(shot, method(shot), options, [&](const AnimatedFrame& frame) {
    ended.sheet = *frame.sheet;
    ended.handles = frame.handles;
    ended.worst_edge = std::max(ended.worst_edge, length_distortion(*frame.sheet).largest);
    ended.crossed += crossings(*frame.sheet) > 0;
    ++ended.frames;
    return true;
  });
  return ended;
}

Method hybrid_of(const Shot& shot) { return hybrid(shot.pattern, shot.paper, 120, {}, 0, 0); }
Method fem_of(const Shot&) { return fem(300); }
Method adaptive_of(const Shot& shot) { return adaptive(shot.pattern, 800); }

/// The shot with every handle `times` as fast until frame 24 of the slow one, then at rest.
Shot faster(Shot shot, int times) {
  for (Handle& handle : shot.handles) {
    const Points3 slow = handle.keyed;
    handle.keyed.resize(40, 3);
    for (int f = 0; f < 40; ++f) handle.keyed.row(f) = slow.row(std::min(times * f, 23));
    if (handle.mode == HandleMode::relative) handle.grab_frame = 1000;
  }
  return shot;
}

/// RMS distance over a grid of the pattern. [m]
double apart(const Ended& a, const Ended& b) {
  const PatternSamples samples(test::rectangle(0.1, 0.1));
  return rms_distance(samples(a.sheet).x, samples(b.sheet).x);
}

TEST(Stability, APushInOneFrameEndsWhereTheSlowOneDoes) {
  for (const auto& method : {hybrid_of, fem_of}) {
    const Ended slow = play(faster(test::s1_push(), 1), 40, method);
    for (const int times : {16, 24}) {
      const Ended fast = play(faster(test::s1_push(), times), 12, method);
      EXPECT_LT(apart(slow, fast), 0.002 * 0.1) << times;
      EXPECT_GT(fast.sheet.x.col(2).cwiseAbs().maxCoeff(), 0.015);  // and that is an arch
    }
  }
}

TEST(Stability, SheetPulledLongerByAFifthIsMetAsFarAsPaperCan) {
  Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
  for (const double x : {0.0, 0.1})
    for (const double y : {0.0, 0.05, 0.1}) {
      Handle handle = test::bare_handle("h" + std::to_string(shot.handles.size()), {x, y}, 12);
      for (int f = 0; f < 12; ++f) handle.keyed(f, 0) *= 1 + 0.02 * std::min(f, 10);
      shot.handles.push_back(handle);
    }
  for (const auto& method : {hybrid_of, adaptive_of}) {
    const Ended ended = play(shot, 12, method);
    EXPECT_TRUE(ended.sheet.x.allFinite());
    EXPECT_LT(ended.worst_edge, 0.01);
    EXPECT_LT(ended.sheet.triangles.rows(), 300);
    for (const HandleFrame& handle : ended.handles) {
      EXPECT_EQ(handle.state, HandleFrame::jammed);
      EXPECT_NEAR((handle.at - handle.keyed).norm(), 0.01, 0.001);  // the 20 mm too much, shared by both sides
    }
  }
}

TEST(Stability, SheetCrushedInOneFrameIsFiniteAndDoesNotPassThroughItself) {
  Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
  for (const double x : {0.0, 0.05, 0.1})
    for (const double y : {0.0, 0.05, 0.1}) {
      if (x == 0.05 && y == 0.05) continue;
      Handle handle = test::bare_handle("h" + std::to_string(shot.handles.size()), {x, y}, 12);
      for (int f = 1; f < 12; ++f) handle.keyed.row(f) << 0.05 + 0.4 * (x - 0.05), 0.05 + 0.4 * (y - 0.05), 0.03 * std::sin(30 * x + 50 * y);
      shot.handles.push_back(handle);
    }
  for (const auto& method : {hybrid_of, fem_of, adaptive_of}) {
    const Ended ended = play(shot, 12, method);
    EXPECT_EQ(ended.frames, 12);
    EXPECT_TRUE(ended.sheet.x.allFinite());
    EXPECT_EQ(ended.crossed, 0);
    EXPECT_LT(ended.worst_edge, 0.10);
    for (std::size_t h = 0; h < ended.handles.size(); ++h) {
      const double lag = (ended.handles[h].at - ended.handles[h].keyed).norm();
      EXPECT_EQ(ended.handles[h].state == HandleFrame::jammed, lag > 1e-4) << h;
    }
  }
}

}  // namespace
}  // namespace paperbake
