// FBX import without ufbx warns of what is lost.

#include "formats/scene/scene_file.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(SceneFbxAssimp, LossesAreWarnedOf) {
  const Scene scene = read_scene(test::sample("S7_stacks.fbx"));
  EXPECT_EQ(scene.first_frame, 1);
  EXPECT_TRUE(test::has_warning(scene, "built without ufbx"));
  EXPECT_TRUE(test::has_warning(scene, "--start-frame"));
}

}  // namespace
}  // namespace paperbake
