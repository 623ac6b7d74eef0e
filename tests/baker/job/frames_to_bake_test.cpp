#include "baker/job/frames_to_bake.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

Scene scene_of_frames(int first, int last, int release) {
  Scene scene;
  scene.first_frame = first;
  scene.last_frame = last;
  Handle handle;
  handle.name = "handle.a";
  handle.release_frame = release;
  scene.sheets.emplace_back().handles = {handle};
  return scene;
}

constexpr int never = std::numeric_limits<int>::max();

TEST(FramesToBakeTest, KeysDecideUnlessAReleaseComesAtTheirEnd) {
  const LastFrame keys = last_frame_to_bake(scene_of_frames(1, 40, never), MovedBy::handles);
  EXPECT_EQ(keys.frame, 40);
  EXPECT_TRUE(keys.why.empty());
  EXPECT_EQ(last_frame_to_bake(scene_of_frames(1, 40, 20), MovedBy::gravity_or_wind).frame, 40);
  const LastFrame release = last_frame_to_bake(scene_of_frames(1, 40, 50), MovedBy::handles);
  EXPECT_EQ(release.frame, 97);
  EXPECT_NE(release.why.find("\"handle.a\", is released at frame 50"), std::string::npos);
}

TEST(FramesToBakeTest, WithoutKeysASheetThatFallsGetsFourSeconds) {
  const LastFrame falls =
      last_frame_to_bake(scene_of_frames(5, 5, never), MovedBy::gravity_or_wind);
  EXPECT_EQ(falls.frame, 100);
  EXPECT_NE(falls.why.find("Frames 5-100"), std::string::npos) << falls.why;
  const LastFrame still = last_frame_to_bake(scene_of_frames(5, 5, never), MovedBy::handles);
  EXPECT_EQ(still.frame, 5);
  EXPECT_NE(still.why.find("nothing moves"), std::string::npos) << still.why;
}

}  // namespace
}  // namespace paperbake
