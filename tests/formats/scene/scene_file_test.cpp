// Scene files as a whole: unreadable files, names, takes, first frame and frame rate.

#include "formats/scene/scene_file.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace paperbake {
namespace {

using test::error_of;
using test::FlatMesh;
using test::GltfFixture;
using test::grid;
using test::handle;
using test::has_warning;
using test::HeldSheet;
using test::sample;
using test::temporary;
using test::whole;

TEST(SceneFile, FilesThatCannotBeReadAreErrors) {
  EXPECT_ERROR("nowhere/fold.glb", "no such file");
  EXPECT_ERROR(testing::TempDir(), "not a file");
  EXPECT_ERROR(temporary("notes.txt", "buy paper"), "not an FBX, glTF or GLB");
  EXPECT_ERROR(temporary("shot.usda", "#usda 1.0"), "USD layer, which is written but not read");
  for (const char* name : {"notes.fbx", "notes.gltf"})
    EXPECT_ERROR(temporary(name, "buy paper"), "cannot be read");
  EXPECT_ERROR(temporary("notes.glb", "buy paper"), "This is a text");
  EXPECT_ERROR(temporary("empty.glb", ""), "is empty");
  EXPECT_ERROR(temporary("triangle.fbx", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "triangle.fbx");
}

TEST(SceneFile, TruncatedFilesAreErrors) {
  const std::string glb = whole(sample("S7_stacks.glb")), fbx = whole(sample("S7_stacks.fbx"));
  EXPECT_ERROR(temporary("cut.glb", glb.substr(0, glb.size() - 100)), "cut off");
  for (int part = 1; part < 8; ++part) {
    EXPECT_NE(error_of(temporary("cut.glb", glb.substr(0, glb.size() * part / 8))), "") << part;
    EXPECT_NE(error_of(temporary("cut.fbx", fbx.substr(0, fbx.size() * part / 8))), "") << part;
  }
}

// assimp follows cycles and nesting until its stack overflows, which must not crash the program.
TEST(SceneFile, FilesThatCrashTheImporterAreErrors) {
  const std::string head =
      "; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXHeaderVersion: 1003\nFBXVersion: "
      "7400\n}\n";
  std::string nested = head;
  for (int depth = 0; depth < 100000; ++depth) nested += "a: {";
  EXPECT_ERROR(temporary("nested.fbx", nested), "nested.fbx\n  The file cannot be read");
  EXPECT_ERROR(temporary("ring.fbx",
                         head + "Objects: {\nModel: 1, \"Model::a\", \"Null\" {\n}\nModel: 2, "
                                "\"Model::b\", \"Null\" {\n}\n}\n"
                                "Connections: {\nC: \"OO\",1,0\nC: \"OO\",2,1\nC: \"OO\",1,2\n}\n"),
               "cannot be read");
}

TEST(SceneFile, ImplausibleCountsAreErrors) {
  std::string glb1("glTF\1\0\0\0\x20\0\0\0\xff\xff\xff\x7f\0\0\0\0", 20);
  EXPECT_ERROR(temporary("one.glb", glb1), "GLB of version 1");
  HeldSheet crowd;
  for (int i = 0; i < 300; ++i) crowd.node("rig", {0, 0, 0});
  crowd.move(crowd.fixed, {0, 96000}, {{0, 0, 0}, {0, 0, 0}});
  EXPECT_ERROR(crowd.write("crowd.gltf"), "96001 frames of 303 nodes");
}

TEST(SceneFile, ASceneWithoutSheetOrHandleIsAnError) {
  EXPECT_ERROR(HeldSheet(grid(2, 2, 0.2, 0.2), "{}", "{}", 1, "leaf").write("leaf.gltf"),
               "the meshes are \"leaf\"");
  GltfFixture bare;
  bare.mesh("paper", grid(2, 2, 0.2, 0.2));
  bare.node("grip", {0, 0, 0});
  EXPECT_ERROR(bare.write("bare.gltf"), "has no handle");
}

TEST(SceneFile, SheetsThatNothingHoldsAreToldInOneSentence) {
  HeldSheet fixture;
  fixture.mesh("paper.leaf", grid(2, 2, 0.1, 0.1));
  EXPECT_TRUE(has_warning(read_scene(fixture.write("leaf.gltf")),
                          "The sheet \"paper.leaf\" has no handle: nothing holds it."));
  fixture.mesh("paper.other", grid(2, 2, 0.1, 0.1));
  const Scene scene = read_scene(fixture.write("leaves.gltf"));
  EXPECT_TRUE(has_warning(scene,
                          "2 sheets have no handle, nothing holds them: \"paper.leaf\", "
                          "\"paper.other\"."));
  EXPECT_EQ(std::count_if(scene.warnings.begin(), scene.warnings.end(),
                          [](const std::string& w) { return w.find("nothing holds") != w.npos; }),
            1);
}

// Of two takes that move a node, the one in which it was exported is used, even if the other has
// more keys.
TEST(SceneFile, ATakeThroughTheRestPositionIsPreferred) {
  HeldSheet fixture;
  fixture.move(
      fixture.moved, {1, 2, 3, 4, 5},
      {{0.1, 0.1, 0}, {0.1, 0.1, 0.001}, {0.1, 0.1, 0.002}, {0.1, 0.1, 0.001}, {0.1, 0.1, 0}});
  const Scene scene = read_scene(fixture.write("foreign_take.gltf"));
  EXPECT_TRUE(has_warning(scene, "moved by several takes"));
  EXPECT_NEAR(
      (handle(scene, "handle.moved").keyed.row(4) - Eigen::RowVector3d(0.18, 0.2, 0)).norm(), 0,
      1e-7);
}

TEST(SceneFile, DuplicateNamesAreErrors) {
  HeldSheet handles;
  handles.node("handle.fixed", {0, 0.2, 0});
  EXPECT_ERROR(handles.write("handles_twice.gltf"), "handle \"handle.fixed\"\n  Two handles");
  HeldSheet sheets;
  sheets.mesh("paper", grid(2, 2, 0.2, 0.2));
  EXPECT_ERROR(sheets.write("sheets_twice.gltf"), "Two sheets");
}

TEST(SceneFile, CompetingTakesAreWarnedOf) {
  HeldSheet fixture;
  fixture.move(fixture.moved, {1, 2, 5}, {{0.2, 0.2, 0}, {0.2, 0.2, 0}, {0.2, 0.2, 0.01}});
  const Scene scene = read_scene(fixture.write("two_takes.gltf"));
  EXPECT_TRUE(has_warning(scene, "first \"handle.moved\" (\"move 2 b\" is used): --take"));
  EXPECT_NEAR(handle(scene, "handle.moved").keyed(4, 2), 0.01, 1e-8);  // of the take with most keys
}

TEST(SceneFile, NodesOfTheSameNameMoveIndependently) {
  HeldSheet fixture;
  const int first = fixture.node("rig", {0, 0, 0}), second = fixture.node("rig", {0, 0, 0}),
            third = fixture.node("rig", {0, 0, 0});
  fixture.move(third, {1, 5}, {{0, 0, 0}, {0, 0, 3}});
  fixture.move(first, {1, 5}, {{0, 0, 0}, {0, 0, 1}});
  const Tracks tracks = read_tracks(fixture.write("three_rigs.gltf"));
  for (const auto& [node, height] : {std::pair(first, 1), {second, 0}, {third, 3}}) {
    EXPECT_EQ(tracks.names.at(node), "rig");
    EXPECT_NEAR(tracks.positions.at(node)(4, 2), height, 1e-7);
  }
}

TEST(SceneFile, NamesAreMatchedWithoutNamespaceCaseAndNumber) {
  HeldSheet fixture(grid(2, 2, 0.2, 0.2), "{}", "{}", 1, "shot:Paper_A.001");
  fixture.node("rig:HANDLE-top", {0.1, 0.2, 0});
  const Scene scene = read_scene(fixture.write("names.gltf"));
  EXPECT_EQ(scene.sheets.at(0).name, "shot:Paper_A.001");
  EXPECT_NEAR((handle(scene, "rig:HANDLE-top").pattern - Vector2d(0.1, 0.2)).norm(), 0, 1e-7);
}

TEST(SceneFile, NotANumberIsAnError) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  FlatMesh mesh = grid(2, 2, 0.2, 0.2);
  mesh.x[4].z() = nan;
  EXPECT_ERROR(HeldSheet(mesh).write("nan_vertex.gltf"), "mesh \"paper\"");
  HeldSheet fixture;
  fixture.move(fixture.fixed, {1, 5}, {{0, 0, 0}, {0, nan, 0}});
  EXPECT_ERROR(fixture.write("nan_key.gltf"), "node \"handle.fixed\"");
  EXPECT_ERROR(fixture.write("nan_key.gltf"), "Its key at 0.20");
}

TEST(SceneFile, StartFrameMovesTheFirstKey) {
  SceneOptions options;
  options.start_frame = 101;
  const Scene scene = read_scene(HeldSheet().write("start.gltf"), options);
  EXPECT_EQ(scene.first_frame, 101);
  EXPECT_EQ(scene.last_frame, 105);
  EXPECT_NEAR(handle(scene, "handle.moved").keyed(1, 0), 0.195, 1e-7);
}

TEST(SceneFile, KeysBetweenFramesAreWarnedOf) {
  SceneOptions options;
  options.fps = 30;  // frame 5 at 24 is 6.25 at 30
  const Scene scene = read_scene(HeldSheet().write("rate.gltf"), options);
  EXPECT_EQ(scene.last_frame, 7);
  EXPECT_TRUE(has_warning(scene,
                          "2 of 2 keys lie between whole frames at 30 frames per second: "
                          "at 24 all lie on whole frames, so --fps 24 is probably right."));
}

TEST(SceneFile, ASheetFarFromTheOriginIsWarnedOf) {
  const auto at = [](double away) {
    return grid(4, 4, 0.2, 0.2, nullptr,
                [away](double u, double v) { return Vector3d(away + u, v, 0); });
  };
  EXPECT_FALSE(has_warning(read_scene(HeldSheet(at(15)).write("near.gltf")), "origin"));
  EXPECT_TRUE(has_warning(read_scene(HeldSheet(at(120)).write("far.gltf")),
                          "The sheet \"paper\" is 120 m away from the origin. Positions in a cache "
                          "are numbers of 32 bits, which are 0.0076 mm apart there"));
}

TEST(SceneFile, AnUnknownTakeIsToldWithWhatHappensWithoutOne) {
  SceneOptions options;
  options.take = "nosuch";
  EXPECT_NE(test::error_of(HeldSheet().write("take.gltf"), options)
                .find("without --take all of them are merged"),
            std::string::npos);
}

TEST(SceneFile, TracksNeedNoSheet) {
  GltfFixture fixture;
  const int child = fixture.node("child", {0, 0.1, 0});
  const int parent =
      fixture.node("parent", {1, 0, 0}, "{}", fmt::format(R"("children":[{}],)", child));
  fixture.make_child(child);
  fixture.move(parent, {2, 4}, {{1, 0, 0}, {1, 0, 2}});
  const Tracks tracks = read_tracks(fixture.write("tracks.gltf"));
  EXPECT_EQ(tracks.first_frame, 2);
  // the single root is a node of the file
  EXPECT_EQ(tracks.names, (std::vector<std::string>{"parent", "child"}));
  EXPECT_NEAR((tracks.positions[1].row(1) - Eigen::RowVector3d(1, 0.1, 1)).norm(), 0, 1e-7);
}

TEST(SceneFile, AMeshWhoseNameGoesOnAsAnotherWordIsIgnoredWhenItIsNoSheet) {
  test::FlatMesh box = test::grid(1, 1, 0.05, 0.05);  // closed: a front and a back
  box.uv.clear();
  box.x[3].z() = 0.01;
  box.corners = {0, 1, 3, 0, 3, 2, 0, 3, 1, 0, 2, 3};
  test::HeldSheet with_prop;
  with_prop.mesh("Paperclip", box);
  const Scene scene = read_scene(with_prop.write("clip.gltf"));
  ASSERT_EQ(scene.sheets.size(), 1u);
  EXPECT_TRUE(test::has_warning(scene, "\"Paperclip\" is ignored"));
  test::HeldSheet sheet_alone(test::grid(2, 2, 0.1, 0.1), "{}", "{}", 1, "Paperclip");
  EXPECT_EQ(read_scene(sheet_alone.write("named.gltf")).sheets.size(), 1u) << "it is a sheet";
  test::HeldSheet prop_alone(box, "{}", "{}", 1, "Paperclip");
  EXPECT_NE(test::error_of(prop_alone.write("alone.gltf")).find("its name begins with \"paper\""),
            std::string::npos);
  test::HeldSheet ignored;
  ignored.mesh("paper.solid", box, R"({"paper_ignore":true})");
  EXPECT_EQ(read_scene(ignored.write("ignored.gltf")).sheets.size(), 1u);
}

TEST(SceneFile, WhatIsTakenForSomethingByItsNameIsSaid) {
  test::HeldSheet held(test::grid(2, 2, 0.1, 0.1), R"({"paper_prest":"copy80"})");
  held.mesh("handlebar", test::grid(1, 1, 0.05, 0.05));
  const Scene scene = read_scene(held.write("bar.gltf"));
  EXPECT_TRUE(test::has_warning(scene, "\"handlebar\" is taken for a handle"));
  EXPECT_FALSE(test::has_warning(scene, "\"handle.fixed\" is taken"));
  EXPECT_TRUE(test::has_warning(scene, "ignored. Did you mean \"paper_preset\"?"));
}

TEST(SceneFile, AHandleBesideItsSheetIsSaidWithARemedyAndKept) {
  test::HeldSheet held(test::grid(2, 2, 0.1, 0.1));
  held.node("handle.far", {0.05, 0.05, 0.01});
  const Scene scene = read_scene(held.write("far.gltf"));
  ASSERT_EQ(scene.sheets.at(0).handles_off.size(), 1u);
  EXPECT_TRUE(test::has_warning(
      scene, scene.sheets[0].handles_off[0] + " Move it onto the sheet, or give it"));
}

TEST(SceneFile, UvSetsAndCustomPropertiesOfTheSheetAreRead) {
  test::HeldSheet held(test::grid(2, 2, 0.2, 0.1),
                       R"({"paper_uv_sets":"Print","title":"Daily","edition":3,"paper_gsm":80})");
  const Scene scene = read_scene(held.write("printed.gltf"));
  const AuthoredSurface& authored = scene.sheets.at(0).authored;
  ASSERT_EQ(authored.attributes.size(), 1u);
  EXPECT_EQ(authored.attributes[0].name, "Print");
  EXPECT_EQ(authored.attributes[0].kind, AttributeKind::uv);
  ASSERT_EQ(authored.attributes[0].values.rows(), 3 * authored.triangles.rows());
  for (Eigen::Index t = 0; t < authored.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((authored.attributes[0].values.row(3 * t + k) -
                 authored.pattern.row(authored.triangles(t, k)) / 0.2)
                    .norm(),
                1e-6);
  EXPECT_EQ(authored.properties.size(), 2u);
  EXPECT_EQ(std::get<std::string>(authored.properties.at("title")), "Daily");
  EXPECT_EQ(std::get<double>(authored.properties.at("edition")), 3);
}

}  // namespace
}  // namespace paperbake
