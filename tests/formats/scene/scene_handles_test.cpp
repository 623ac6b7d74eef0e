// Handles: the sheet that they hold, where and when, and the head or tail of bones.

#include "formats/scene/scene_file.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <string>

namespace paperbake {
namespace {

using test::error_of;
using test::FlatMesh;
using test::GltfFixture;
using test::grid;
using test::handle;
using test::has_warning;
using test::HeldSheet;

TEST(SceneHandles, HandlesMoveLinearlyBetweenKeys) {
  const Scene scene = read_scene(HeldSheet().write("line.gltf"));
  EXPECT_EQ(scene.first_frame, 1);
  EXPECT_EQ(scene.last_frame, 5);
  EXPECT_NEAR(
      (handle(scene, "handle.moved").keyed.row(1) - Eigen::RowVector3d(0.195, 0.2, 0)).norm(), 0,
      1e-7);
}

TEST(SceneHandles, AHandleThatJumpsNamesFramesAndDistance) {
  HeldSheet fixture;
  const int wild = fixture.node("handle.wild", {0.1, 0, 0});
  fixture.move(wild, {1, 2, 3, 5}, {{0.1, 0, 0}, {0.1, 0, 0}, {0.1, 0, 2}, {0.1, 0, 2}});
  const std::string text = error_of(fixture.write("jump.gltf"));
  EXPECT_NE(text.find("handle \"handle.wild\", frames 2-3"), std::string::npos) << text;
  EXPECT_NE(text.find("jumps 2 m"), std::string::npos) << text;
}

TEST(SceneHandles, ANodeThatGroupsHandlesIsWarnedOf) {
  HeldSheet fixture;
  fixture.make_child(fixture.fixed);
  fixture.make_child(fixture.moved);
  fixture.node("handles_grp", {0, 0, 0}, "{}",
               fmt::format(R"("children":[{},{}],)", fixture.fixed, fixture.moved));
  EXPECT_TRUE(has_warning(read_scene(fixture.write("group.gltf")),
                          "\"handles_grp\" has 2 handles below it"));
}

TEST(SceneHandles, MotionlessHandlesAndKeyedSheetsAreWarnedOf) {
  GltfFixture still;
  still.mesh("paper", grid(2, 2, 0.2, 0.2));
  still.node("handle", {0, 0, 0});
  EXPECT_TRUE(has_warning(read_scene(still.write("still.gltf")),
                          "No handle moves: the file has no animation."));
  HeldSheet keyed;
  EXPECT_FALSE(has_warning(read_scene(keyed.write("unkeyed.gltf")), "is keyed"));
  keyed.move(keyed.paper, {1, 5}, {{0, 0, 0}, {0, 0, 0.1}});
  const Scene scene = read_scene(keyed.write("keyed.gltf"));
  EXPECT_TRUE(has_warning(scene, "The sheet \"paper\" is keyed"));
  EXPECT_FALSE(has_warning(scene, "No handle moves"));
}

TEST(SceneHandles, OfWhichAllAreIgnoredAreNotSaidToBeMissing) {
  GltfFixture fixture;
  fixture.mesh("paper", grid(2, 2, 0.2, 0.2));
  for (const char* name : {"handle.a", "handle.b"})
    fixture.node(name, {0, 0, 0}, R"({"paper_ignore":true})");
  EXPECT_ERROR(fixture.write("ignored.gltf"),
               "All handles of the scene are ignored: \"handle.a\" and 1 more.");
  EXPECT_ERROR(HeldSheet(grid(2, 2, 0.2, 0.2), R"({"paper_ignore":true})").write("ignored.gltf"),
               "node \"paper\"\n  The scene has no sheet: this mesh is named like one, but");
}

TEST(SceneHandles, AHandleThatHoldsAllOfTheSheetIsWarnedOf) {
  const auto warned = [](const char* extras) {
    return has_warning(
        read_scene(HeldSheet(grid(2, 2, 0.2, 0.2), "{}", extras).write("radius.gltf")),
        "\"handle.moved\" holds all of the sheet \"paper\" stiff: its paper_radius is");
  };
  EXPECT_TRUE(warned(R"({"paper_radius":5})"));
  EXPECT_FALSE(warned(R"({"paper_radius":0.02})"));
}

TEST(SceneHandles, AHandleFarFromEverySheetIsAnError) {
  HeldSheet fixture;
  fixture.node("handle.far", {0.5, 0.6, 0});
  EXPECT_ERROR(fixture.write("far.gltf"), "is 0.5 m away from the sheet \"paper\"");
}

TEST(SceneHandles, AKeyedScaleBelowHalfReleasesAHandle) {
  HeldSheet fixture;
  const int shrinking = fixture.node("handle.shrinking", {0, 0.2, 0});
  fixture.scale(shrinking, {1, 3, 4, 5}, {1, 1, 0.01, 1});
  const Scene scene = read_scene(fixture.write("scale.gltf"));
  EXPECT_EQ(handle(scene, "handle.shrinking").release_frame, 4);
  EXPECT_FALSE(handle(scene, "handle.shrinking").held(5));
}

TEST(SceneHandles, HandlesGoToTheirTargetElseToTheNearestSheet) {
  HeldSheet fixture;
  FlatMesh above = grid(2, 2, 0.2, 0.2);
  for (Vector3d& p : above.x) p.z() += 0.01;
  fixture.mesh("paper.above", above);
  fixture.node("handle.near", {0.1, 0.1, 0.009});
  fixture.node("handle.told", {0.1, 0.1, 0.009}, R"({"paper_target":"paper"})");
  const Scene scene = read_scene(fixture.write("target.gltf"));
  ASSERT_EQ(scene.sheets.size(), 2u);
  EXPECT_EQ(scene.sheets[0].handles.back().name, "handle.told");
  EXPECT_EQ(scene.sheets[1].handles.back().name, "handle.near");
}

TEST(SceneHandles, BonesHoldAtTheirHeadOrTail) {
  HeldSheet fixture;
  const int leaf = fixture.node("finger_leaf", {0, 0, 0.05});
  const int finger = fixture.node("finger", {0.1, 0.1, 0}, R"({"paper_point":"tail"})",
                                  fmt::format(R"("children":[{}],)", leaf));
  fixture.make_child(leaf);
  const int end = fixture.node("handle.bone_end", {0, 0, 0.03});
  const int bone = fixture.node("handle.bone", {0.05, 0.1, 0}, R"({"paper_point":"head"})",
                                fmt::format(R"("children":[{}],)", end));
  fixture.make_child(end);
  fixture.move(finger, {1, 5}, {{0.1, 0.1, 0}, {0.1, 0.1, 0.02}});
  ASSERT_GT(bone, finger);
  const Scene scene = read_scene(fixture.write("bones.gltf"));
  EXPECT_EQ(scene.sheets.at(0).handles.size(), 4u);  // handle.bone_end is not a handle
  EXPECT_NEAR((handle(scene, "finger").keyed.row(4) - Eigen::RowVector3d(0.1, 0.1, 0.07)).norm(), 0,
              1e-7);
  EXPECT_NEAR((handle(scene, "handle.bone").keyed.row(4) - Eigen::RowVector3d(0.05, 0.1, 0)).norm(),
              0, 1e-7);

  HeldSheet lost;
  lost.node("finger", {0.1, 0.1, 0}, R"({"paper_point":"tail"})");
  EXPECT_ERROR(lost.write("lost_tail.gltf"), "0 children");
}

}  // namespace
}  // namespace paperbake
