#include "core/hands/known_handles.h"

#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

constexpr int frames = 20, first_frame = 101;

/// A handle that is keyed beside the sheet, and that goes up from a row on.
Handle picked_up(const Vector2d& p, int grab_row, int moves_from) {
  Handle handle = test::bare_handle("handle", p, frames);
  handle.mode = HandleMode::relative;
  handle.grab_frame = first_frame + grab_row;
  for (int f = 0; f < frames; ++f)
    handle.keyed.row(f) +=
        Eigen::RowVector3d(0.03, -0.02, 0.1 + 0.01 * std::max(0, f - moves_from));
  return handle;
}

Shot with(const std::vector<Handle>& handles) {
  Shot shot = test::blank_shot(test::rectangle(0.2, 0.1));
  shot.start.x.col(2) = 0.5 * shot.start.x.col(0);  // it begins on a slope
  shot.handles = handles;
  return shot;
}

std::vector<Handle> known(const Shot& shot) {
  return with_known_places(shot.handles, shot.start, first_frame);
}

TEST(KnownHandlesTest, AHandleThatPicksUpALyingSheetIsKeyedFromWhereTheSheetIs) {
  const Shot shot = with({picked_up({0.05, 0.03}, 4, 10), picked_up({0.15, 0.03}, 6, 12)});
  const std::vector<Handle> handles = known(shot);
  for (const Handle& handle : handles) {
    EXPECT_EQ(handle.mode, HandleMode::absolute);
    const Eigen::RowVector3d lying(handle.pattern.x(), handle.pattern.y(),
                                   0.5 * handle.pattern.x());
    EXPECT_LT((handle.keyed.row(handle.grab_frame - first_frame) - lying).norm(), 1e-12);
  }
  EXPECT_NEAR(handles[0].keyed(19, 2) - handles[0].keyed(10, 2), 0.09, 1e-12);
  EXPECT_EQ(handles[1].grab_frame, first_frame + 6);
}

TEST(KnownHandlesTest, AHandleThatTakesHoldOfAMovedSheetStaysRelative) {
  const Shot shot = with({picked_up({0.05, 0.03}, 4, 5), picked_up({0.15, 0.03}, 6, 12)});
  const std::vector<Handle> handles = known(shot);
  EXPECT_EQ(handles[0].mode, HandleMode::absolute);
  EXPECT_EQ(handles[1].mode, HandleMode::relative);
  EXPECT_EQ(handles[1].keyed, shot.handles[1].keyed);
}

TEST(KnownHandlesTest, MotionBeforeAHandleTakesHoldMovesNothing) {
  Shot shot = with({picked_up({0.05, 0.03}, 8, 2), picked_up({0.15, 0.03}, 8, 12)});
  shot.handles[0].keyed.bottomRows(frames - 8).rowwise() = shot.handles[0].keyed.row(8).eval();
  for (const Handle& handle : known(shot)) EXPECT_EQ(handle.mode, HandleMode::absolute);
}

/// A handle that is keyed where the sheet lies, and goes up from a row on.
Handle on_the_sheet(const Vector2d& p, int moves_from) {
  Handle handle = test::bare_handle("handle", p, frames);
  for (int f = 0; f < frames; ++f)
    handle.keyed(f, 2) = 0.5 * p.x() + 0.01 * std::max(0, f - moves_from);
  return handle;
}

TEST(KnownHandlesTest, AHandleThatIsKeyedElsewhereMovesTheSheetAtOnce) {
  Handle elsewhere = on_the_sheet({0.05, 0.03}, frames);
  elsewhere.keyed.col(2).array() += 0.1;
  elsewhere.grab_frame = first_frame + 5;
  for (const int grab : {4, 6}) {
    const std::vector<Handle> handles = known(with({elsewhere, picked_up({0.15, 0.03}, grab, 12)}));
    EXPECT_EQ(handles[1].mode, grab < 5 ? HandleMode::absolute : HandleMode::relative);
  }
}

TEST(KnownHandlesTest, AbsoluteHandlesStayAsTheyAre) {
  const Handle moved = on_the_sheet({0.05, 0.03}, 1);
  const Shot shot = with({moved, picked_up({0.15, 0.03}, 1, 12), picked_up({0.1, 0.03}, 2, 12)});
  const std::vector<Handle> handles = known(shot);
  EXPECT_EQ(handles[0].keyed, moved.keyed);
  EXPECT_EQ(handles[1].mode, HandleMode::absolute) << "it takes hold before that one moves";
  EXPECT_EQ(handles[2].mode, HandleMode::relative);
}

}  // namespace
}  // namespace paperbake
