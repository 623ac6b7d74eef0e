#include "baker/bake/render_pass.h"

#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

constexpr double size = 0.1;  // [m]

/// A square sheet folded along its middle, at z = up. [m]
Sheet folded(double up, double angle) {
  Sheet sheet;
  sheet.pattern.resize(6, 2);
  sheet.pattern << 0, 0, size / 2, 0, size, 0, 0, size, size / 2, size, size, size;
  sheet.triangles.resize(4, 3);
  sheet.triangles << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4;
  sheet.x.resize(6, 3);
  for (int v = 0; v < 6; ++v) {
    const double s = sheet.pattern(v, 0) - size / 2;
    sheet.x.row(v) << s * std::cos(angle), sheet.pattern(v, 1), std::abs(s) * std::sin(angle) + up;
  }
  return sheet;
}

/// Frames of it, as high as is said.
ShotRecord record_of(const std::vector<double>& up) {
  ShotRecord record;
  for (std::size_t f = 0; f < up.size(); ++f) {
    const Sheet sheet = folded(up[f], 0.2 * (f + 1));
    AnimatedFrame frame;
    frame.frame = static_cast<int>(f) + 1;
    frame.sheet = &sheet;
    record.add(frame);
  }
  return record;
}

TEST(RenderPassTest, SheetsThatComeNearEachOtherInSomeFrameAreRenderedTogether) {
  const ShotRecord a = record_of({0, 0, 0}), b = record_of({1, 0.05, 1}),
                   far = record_of({2, 2, 2}), between = record_of({2, 0.1, 3});
  using Lists = std::vector<std::vector<std::size_t>>;
  EXPECT_EQ(near_each_other({&a, &far, &b}), (Lists{{0, 2}, {1}}));
  EXPECT_EQ(near_each_other({&a, &far}), (Lists{{0}, {1}}));
  EXPECT_EQ(near_each_other({&far, &a, &b, &between}), (Lists{{0, 1, 2, 3}}))
      << "by way of those between";
  EXPECT_TRUE(near_each_other({}).empty());
}

TEST(RenderPassTest, SheetsOneInTheOtherAreApartAndTheSameForAnyNumberOfThreads) {
  const ShotRecord low = record_of({0, 0, 0, 0, 0, 0}),
                   high = record_of({1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4});
  const Shot shot = test::blank_shot(test::rectangle(size, size));
  const auto positions = [&](int threads, bool together) {
    std::vector<std::vector<Points3>> all(2);
    const auto write = [&](std::size_t s) {
      return [&all, s](int, const CacheFrame& frame, const RenderStatistics& rendered) {
        EXPECT_EQ(rendered.crossings, 0);
        EXPECT_EQ(rendered.crossings_with_others, 0);
        all[s].push_back(frame.x);
      };
    };
    const RenderInput first{&low, &shot, {}, write(0)}, second{&high, &shot, {}, write(1)};
    const FrameSpan frames{1, 6, 1};
    if (together)
      render_shot({first, second}, Quality::draft, frames, 24, threads);
    else
      render_shot({first}, Quality::draft, frames, 24, threads),
          render_shot({second}, Quality::draft, frames, 24, threads);
    return all;
  };
  const auto one = positions(1, true);
  ASSERT_EQ(one[0].size(), 6u);
  ASSERT_EQ(one[1].size(), 6u);
  EXPECT_EQ(positions(3, true), one);
}

}  // namespace
}  // namespace paperbake
