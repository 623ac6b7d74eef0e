// Whole shots in which the sheet touches itself, and one in which it does not.

#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

std::vector<Points3> shapes(const Shot& shot, const MethodChoice& method,
                            const AnimateOptions& options, bool& touched) {
  std::vector<Points3> all;
  touched = false;
  animate(shot, method, options, [&](const AnimatedFrame& f) {
    all.push_back(f.sheet->x);
    touched |= f.statistics.contact;
    return true;
  });
  return all;
}

TEST(SelfContactShotsTest, AShotInWhichNothingTouchesIsBitIdenticalToOneWithoutContact) {
  const Shot shot = test::s1_push();
  AnimateOptions options;
  options.last_frame = 60;
  options.plasticity = Plasticity::on;
  bool touched, unused;
  const auto method = [&] { return hybrid(shot.pattern, shot.paper, 100, {}, 1, 0); };
  const std::vector<Points3> with = shapes(shot, method(), options, touched);
  options.elastic.contact = SelfContact::off;
  const std::vector<Points3> without = shapes(shot, method(), options, unused);
  ASSERT_EQ(with.size(), 60u);
  EXPECT_FALSE(touched);
  for (std::size_t f = 0; f < with.size(); ++f) ASSERT_TRUE(with[f] == without[f]) << f;
}

/// Eight handles around a sheet of 21 cm approach its centre to 45 % of their distance in 30
/// frames.
Shot crumple() {
  const int frames = 34;
  const double side = 0.21;
  Shot shot = test::blank_shot(test::rectangle(side, side));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (i == 1 && j == 1) continue;
      Handle handle = test::bare_handle("handle." + std::to_string(3 * i + j),
                                        {0.5 * side * i, 0.5 * side * j}, frames);
      handle.radius.reset();
      for (int f = 0; f < frames; ++f) {
        const double share = 1 - 0.55 * std::min(f, 30) / 30.0, middle = 0.5 * side;
        handle.keyed.row(f) << middle + share * middle * (i - 1), middle + share * middle * (j - 1),
            0.02 * std::min(f, 30) / 30.0 * ((i + j) % 2);
      }
      shot.handles.push_back(handle);
    }
  return shot;
}

TEST(SelfContactShotsTest, ACrumpledSheetNeverPassesThroughItself) {
  const Shot shot = crumple();
  int crossed[2] = {0, 0}, touching = 0;
  double stretch = 0;
  for (const SelfContact contact : {SelfContact::automatic, SelfContact::off}) {
    AnimateOptions options;
    options.last_frame = 34;
    options.seed = 2;
    options.plasticity = Plasticity::on;
    options.elastic.contact = contact;
    const bool on = contact == SelfContact::automatic;
    animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 2, 0), options,
            [&](const AnimatedFrame& f) {
              crossed[on] += crossings(*f.sheet);
              if (on) {
                touching = std::max(touching, f.statistics.touching);
                stretch = std::max(stretch, length_distortion(*f.sheet).largest);
              }
              return true;
            });
  }
  EXPECT_GT(crossed[0], 0);  // else this shot proves nothing
  EXPECT_EQ(crossed[1], 0);
  EXPECT_GT(touching, 0);
  EXPECT_LT(stretch, 0.02);
}

TEST(SelfContactShotsTest, ACrumpledSheetAtRestStillTouchesItself) {
  const Shot shot = crumple();
  AnimateOptions options;
  options.last_frame = 60;
  options.seed = 2;
  options.plasticity = Plasticity::on;
  int touching = 0, asleep = 0;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 2, 0), options,
          [&](const AnimatedFrame& f) {
            if (f.frame > 40 && f.statistics.substeps == 0) {
              ++asleep;
              EXPECT_EQ(f.statistics.touching, touching) << f.frame;
              EXPECT_TRUE(f.statistics.contact);
            }
            touching = f.statistics.touching;
            return true;
          });
  EXPECT_GT(asleep, 5);
  EXPECT_GT(touching, 0);
}

/// The left half of a strip is held flat by six handles; two carry the right end over it, then
/// through it as keyed, and back up from frame 37 to 43.
/// pressing  [frames] from frame 25 on, in which the end goes down
Shot pressed_flap(int frames, double pressing) {
  Shot shot = test::blank_shot(test::rectangle(0.2, 0.05));
  for (const double u : {0.0, 0.05, 0.1})
    for (const double v : {0.0, 0.05})
      shot.handles.push_back(
          test::bare_handle("handle.flat" + std::to_string(shot.handles.size()), {u, v}, frames));
  for (const double v : {0.0, 0.05}) {
    Handle end = test::bare_handle("handle.end" + std::to_string(v), {0.2, v}, frames);
    const double inset = v == 0 ? 0.012 : -0.012;
    for (int f = 0; f < frames; ++f) {
      const double a = M_PI * std::min(f, 23) / 23.0;  // around the middle, and a little narrower
      const double down = f < 24   ? 0
                          : f < 36 ? std::min(1.0, (f - 24) / pressing)
                                   : std::max(0.0, (43 - f) / 7.0);
      end.keyed.row(f) << 0.1 + 0.07 * std::cos(a) + 0.03 * (1 - a / M_PI), v + inset * a / M_PI,
          0.06 * std::sin(a) + 0.02 * a / M_PI - 0.03 * down;
    }
    shot.handles.push_back(end);
  }
  return shot;
}

TEST(SelfContactShotsTest, AHandlePressedIntoTheSheetIsJammedUntilItComesBack) {
  // Pressed layers open slowly, because collision-free steps between them are short: the handle
  // comes back by frame 43, and has 17 frames more.
  const int frames = 60;
  const Shot shot = pressed_flap(frames, 10.5);
  AnimateOptions options;
  options.last_frame = frames;
  int jammed_while_pressed = 0;
  double lag = 0;
  HandleFrame last;
  animate(shot, fem(120), options, [&](const AnimatedFrame& f) {
    EXPECT_EQ(crossings(*f.sheet), 0) << f.frame;
    last = f.handles.back();
    if (last.state == HandleFrame::jammed) {
      EXPECT_GT(f.frame, 25);
      ++jammed_while_pressed;
      lag = std::max(lag, (last.at - last.keyed).norm());
    }
    return true;
  });
  EXPECT_GE(jammed_while_pressed, 3);
  EXPECT_GT(lag, 1e-3);
  EXPECT_EQ(last.state, HandleFrame::held);
  EXPECT_LT((last.at - last.keyed).norm(), 1e-4);
}

TEST(SelfContactShotsTest, HandlesThatGaveWayAreMetExactlyOnceNothingTouches) {
  constexpr double side = 0.2;  // [m]
  AnimateOptions options;
  options.last_frame = 60;
  int jammed = 0, free_again = 0;
  animate(pressed_flap(60, 11), fem(120), options, [&](const AnimatedFrame& f) {
    jammed += f.handles.back().state == HandleFrame::jammed;
    if (f.statistics.contact || jammed == 0) return true;
    ++free_again;
    for (const HandleFrame& h : f.handles)
      EXPECT_LT((h.at - h.keyed).norm(), 1e-6 * side) << f.frame;
    return true;
  });
  EXPECT_GT(jammed, 0);
  EXPECT_GT(free_again, 10);
}

}  // namespace
}  // namespace paperbake
