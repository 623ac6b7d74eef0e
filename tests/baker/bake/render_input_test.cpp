// Which sheets are rendered together, and which frames they have.

#include "baker/bake/render_input.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A square of 100 mm, in each frame so far to the right. [m]
ShotRecord record_of(const std::vector<double>& right) {
  ShotRecord record;
  Sheet sheet = test::strip_sheet(0.1, 0.1, 2);
  const Points3 home = sheet.x;
  for (std::size_t k = 0; k < right.size(); ++k) {
    sheet.x = home;
    sheet.x.col(0).array() += right[k];
    AnimatedFrame frame;
    frame.frame = static_cast<int>(k);
    frame.sheet = &sheet;
    record.add(frame);
  }
  return record;
}

TEST(RenderInput, SheetsThatComeNearEachOtherInSomeFrameAreRenderedTogether) {
  const ShotRecord a = record_of({0, 0, 0}), b = record_of({1, 0.05, 1}),
                   far = record_of({2, 2, 2}), between = record_of({2, 0.1, 3});
  using Groups = std::vector<std::vector<std::size_t>>;
  EXPECT_EQ(groups_near_each_other({&a, &far, &b}), (Groups{{0, 2}, {1}}));
  EXPECT_EQ(groups_near_each_other({&a, &far}), (Groups{{0}, {1}}));
  EXPECT_EQ(groups_near_each_other({&far, &a, &b, &between}), (Groups{{0, 1, 2, 3}}))
      << "by way of those between";
  EXPECT_TRUE(groups_near_each_other({}).empty());
}

TEST(RenderInput, AFrameRestsWhenNoSheetMovesAndNoneIsMissing) {
  const ShotRecord rests = record_of({0, 0, 0}), moves = record_of({3, 3, 4}),
                   ends = record_of({7});
  const std::vector<RenderInput> both{{&rests, nullptr}, {&moves, nullptr}};
  EXPECT_FALSE(simulated_alike(both, 0)) << "there is none before";
  EXPECT_TRUE(simulated_alike(both, 1));
  EXPECT_FALSE(simulated_alike(both, 2));
  const std::vector<RenderInput> short_one{{&rests, nullptr}, {&ends, nullptr}};
  EXPECT_EQ(frames_of_any(short_one), 3U);
  EXPECT_EQ(sheets_with_frame(short_one, 0), 2U);
  EXPECT_EQ(sheets_with_frame(short_one, 1), 1U);
  EXPECT_FALSE(simulated_alike(short_one, 1)) << "one sheet is no longer there";
}

}  // namespace
}  // namespace paperbake
