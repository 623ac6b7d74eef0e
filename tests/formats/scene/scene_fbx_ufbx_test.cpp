// FBX import with ufbx: curves, layers, extrapolation, inherited scale, bones, frame rates.

#include "formats/scene/scene_file.h"
#include "formats/scene/scene_import.h"

#include "tests/formats/scene/fbx_fixture.h"
#include "tests/formats/scene/scene_fixture.h"
#include "tests/formats/scene/track_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {
namespace {

using test::FbxCurve;
using test::FbxFixture;
using test::has_warning;
using test::sample;
using test::temporary;
using test::whole;

const std::filesystem::path data(PAPERBAKE_DATA);

/// The x of a node [cm] at the frames of the clip, and the first of these frames.
struct XTrack {
  int first;
  std::vector<double> x;
};

XTrack x_track(const std::filesystem::path& path, const std::string& node = "a",
               const SceneOptions& options = {}) {
  const Tracks tracks = read_tracks(path, options);
  const auto at = std::find(tracks.names.begin(), tracks.names.end(), node) - tracks.names.begin();
  XTrack track{tracks.first_frame, {}};
  for (long f = 0; f < tracks.positions.at(at).rows(); ++f)
    track.x.push_back(100 * tracks.positions[at](f, 0));
  return track;
}

/// A node "a" whose x follows one curve over a clip.
std::filesystem::path moved(const std::string& name, const FbxCurve& curve, double first,
                            double last) {
  FbxFixture fbx;
  const auto a = fbx.node("a");
  fbx.stack("Take 001", first, last);
  fbx.curve(fbx.layer(), a, "Lcl Translation", 'X', curve);
  return fbx.write(name);
}

void expect_track(const XTrack& track, int first, const std::vector<double>& x,
                  double tolerance = 1e-6) {
  EXPECT_EQ(track.first, first);
  ASSERT_EQ(track.x.size(), x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_NEAR(track.x[i], x[i], tolerance) << "frame " << first + static_cast<int>(i);
}

class SceneFbxUfbxMaya : public testing::TestWithParam<const char*> {};

TEST_P(SceneFbxUfbxMaya, EveryNodeIsWhereMayaHadIt) {
  const test::TrackError error =
      test::track_error(read_tracks(data / (GetParam() + std::string(".fbx"))),
                        data / (GetParam() + std::string(".csv")));
  EXPECT_GT(error.compared, 20);
  ASSERT_GT(error.motion, 0.005);
  EXPECT_LE(error.worst, 1e-5 * error.motion);
}

INSTANTIATE_TEST_SUITE_P(Files, SceneFbxUfbxMaya,
                         testing::Values("maya_anim_interpolation_7700_ascii",
                                         "maya_anim_layers_7500_binary",
                                         "maya_anim_pivot_rotate_7700_ascii"),
                         [](const auto& info) { return std::string(info.param); });

TEST(SceneFbxUfbx, StepsHoldTheirValueOrTakeTheNextOne) {
  expect_track(x_track(moved("held.fbx", {{1, 3, 5}, {1, 2, 4}, 2}, 1, 5)), 1, {1, 1, 2, 2, 4});
  expect_track(x_track(moved("late.fbx", {{1, 3, 5}, {1, 2, 4}, 258}, 1, 5)), 1, {1, 2, 2, 4, 4});
}

TEST(SceneFbxUfbx, StepsAreOnTheirFrameAtRatesOfVideo) {
  FbxFixture fbx;
  fbx.settings = R"(P: "TimeMode", "enum", "", "",9)";
  fbx.fps = 30000.0 / 1001;
  const auto a = fbx.node("a");
  fbx.stack("Take 001", 1001, 1100);
  FbxCurve steps{{}, {}, 2, {}};
  for (int f = 1001; f <= 1100; ++f) {
    steps.frames.push_back(f);
    steps.values.push_back(f);
  }
  fbx.curve(fbx.layer(), a, "Lcl Translation", 'X', steps);
  expect_track(x_track(fbx.write("video.fbx")), 1001, steps.values, 1e-4);
}

TEST(SceneFbxUfbx, CubicsFollowTheirSlopes) {
  // x³ over a second: tangents 0 and 3 per second; with weights of 1/3 Bezier time is uniform
  std::vector<double> cube;
  for (int f = 0; f <= 24; ++f) cube.push_back(std::pow(f / 24.0, 3));
  expect_track(x_track(moved("cubic.fbx", {{0, 24}, {0, 1}, 1032, {0, 3}}, 0, 24)), 0, cube, 1e-5);
}

TEST(SceneFbxUfbx, CurvesGoOnBeyondTheirKeys) {
  const auto path = [](char after) {
    FbxCurve curve{{1, 3}, {0, 2}};
    curve.after = after;
    return moved(std::string("after_") + after + ".fbx", curve, 1, 7);
  };
  expect_track(x_track(path('C')), 1, {0, 1, 2, 2, 2, 2, 2});
  // at the seam either value is right; the next lines check the frames between
  expect_track(x_track(path('R')), 1, {0, 1, 2, 1, 0, 1, 0}, 2.0001);
  EXPECT_NEAR(x_track(path('R')).x.at(3), 1, 1e-6);
  EXPECT_NEAR(x_track(path('R')).x.at(5), 1, 1e-6);
  expect_track(x_track(path('A')), 1, {0, 1, 2, 3, 4, 5, 6});
  expect_track(x_track(path('M')), 1, {0, 1, 2, 1, 0, 1, 2});
  FbxCurve before{{5, 7}, {0, 2}};
  before.before = 'A';
  expect_track(x_track(moved("before.fbx", before, 1, 7)), 1, {-4, -3, -2, -1, 0, 1, 2});
}

TEST(SceneFbxUfbx, CurvesThatGoOnAreSampledOverTheWholeClip) {
  const auto frames = [](char after) {
    FbxCurve curve{{1, 3}, {0, 2}};
    curve.after = after;
    const std::filesystem::path path = moved("shot.fbx", curve, 1, 9);
    const ImportedFile file = import_in_process(path);
    EXPECT_EQ(file.takes.at(0).motions.at(0).key_times.size(), 2u);
    return file.takes[0].motions.at(0).translation.keys.back().time * 24;
  };
  EXPECT_NEAR(frames('C'), 3, 1e-9);
  EXPECT_NEAR(frames('A'), 9, 1e-9);
}

TEST(SceneFbxUfbx, LayersAddByTheirWeight) {
  FbxFixture fbx;
  const auto a = fbx.node("a");
  fbx.stack("Take 001", 1, 3);
  fbx.curve(fbx.layer(), a, "Lcl Translation", 'X', {{1, 3}, {0, 2}});
  fbx.curve(
      fbx.layer(
          "P: \"Weight\", \"Number\", \"\", \"A\",25\nP: \"BlendMode\", \"enum\", \"\", \"\",0"),
      a, "Lcl Translation", 'X', {{1, 3}, {0, 8}});
  expect_track(x_track(fbx.write("layers.fbx")), 1, {0, 2, 4});
}

TEST(SceneFbxUfbx, ScaleIsInheritedAsTheNodeSays) {
  // the parent is scaled by (2, 3, 1), the child is at x = 10 and rotated by 90 degrees about z,
  // the grandchild is at (1, 0, 0) of the child
  const auto tip = [](int inherit) {
    FbxFixture fbx;
    const auto parent = fbx.node("parent", 0, FbxFixture::vector("Lcl Scaling", {2, 3, 1}));
    const auto child =
        fbx.node("child", parent,
                 fmt::format("P: \"InheritType\", \"enum\", \"\", \"\",{}\n", inherit) +
                     FbxFixture::vector("Lcl Translation", {10, 0, 0}) +
                     FbxFixture::vector("Lcl Rotation", {0, 0, 90}) +
                     FbxFixture::vector("Lcl Scaling", {5, 1, 1}));
    const auto grandchild =
        fbx.node("tip", child, FbxFixture::vector("Lcl Translation", {1, 0, 0}));
    fbx.stack("Take 001", 1, 2);
    fbx.curve(fbx.layer(), grandchild, "Lcl Translation", 'X', {{1, 2}, {1, 2}}, {1, 0, 0});
    const Tracks tracks = read_tracks(fbx.write("inherit.fbx"));
    const auto at =
        std::find(tracks.names.begin(), tracks.names.end(), "tip") - tracks.names.begin();
    return Vector3d(100 * tracks.positions.at(at).row(1));  // the file's y is the world's z
  };
  // RSrs: the parent's scale acts along the parent's axes
  EXPECT_NEAR((tip(1) - Vector3d(20, 0, 3 * 5 * 2)).norm(), 0, 1e-9);
  // RrSs: the scales are multiplied axis by axis, along the child's axes
  EXPECT_NEAR((tip(0) - Vector3d(20, 0, 2 * 5 * 2)).norm(), 0, 1e-9);
  EXPECT_NEAR((tip(2) - Vector3d(20, 0, 5 * 2)).norm(), 0,
              1e-9);  // Rrs: only the child's own scale
}

TEST(SceneFbxUfbx, TracksBeginWhereTheClipDoes) {
  expect_track(x_track(moved("late_clip.fbx", {{1001, 1003}, {0, 2}}, 1001, 1004)), 1001,
               {0, 1, 2, 2});
  expect_track(x_track(moved("negative.fbx", {{-10, -8}, {0, 2}}, -10, -7)), -10, {0, 1, 2, 2});
  SceneOptions options;
  options.start_frame = 5;
  EXPECT_EQ(
      x_track(moved("moved_clip.fbx", {{1001, 1003}, {0, 2}}, 1001, 1003), "a", options).first, 5);
}

TEST(SceneFbxUfbx, AnotherFrameRateSamplesTheCurvesAtItsFrames) {
  SceneOptions options;
  options.fps = 48;
  expect_track(x_track(moved("faster.fbx", {{0, 1}, {0, 1}, 1032, {0, 0}}, 0, 1), "a", options), 0,
               {0, 0.5, 1}, 1e-6);
  expect_track(x_track(moved("faster_step.fbx", {{0, 1, 2}, {0, 1, 2}, 2}, 0, 2), "a", options), 0,
               {0, 0, 1, 1, 2});
}

TEST(SceneFbxUfbx, BonesCarryPropertiesOnThemselvesOrOnTheirData) {
  FbxFixture fbx;
  const auto bone = fbx.node("bone", 0, "", "LimbNode",
                             FbxFixture::property("paper_point", "KString", "\"tail\"") +
                                 FbxFixture::property("paper_radius", "double", "0.002"));
  fbx.node("bone_end", bone, FbxFixture::vector("Lcl Translation", {3, 0, 0}), "LimbNode");
  fbx.node("max", 0,
           "P: \"UDP3DSMAX\", \"KString\", \"\", \"U\", \"paper_mode = "
           "relative&cr;&lf;paper_grab_frame=24&cr;&lf;paper_size = [0.2, 0.1]\"\n");
  const ImportedFile file = import_in_process(fbx.write("bones.fbx"));
  ASSERT_EQ(file.nodes.size(), 3u);
  EXPECT_EQ(std::get<std::string>(file.nodes[0].properties.at("paper_point")), "tail");
  EXPECT_EQ(std::get<double>(file.nodes[0].properties.at("paper_radius")), 0.002);
  EXPECT_EQ(std::get<std::string>(file.nodes[2].properties.at("paper_mode")), "relative");
  EXPECT_EQ(std::get<std::string>(file.nodes[2].properties.at("paper_grab_frame")), "24");
  EXPECT_EQ(std::get<std::vector<double>>(file.nodes[2].properties.at("paper_size")).size(), 2u);
}

TEST(SceneFbxUfbx, OnlyTheNamedTakeIsUsed) {
  FbxFixture fbx;
  const auto a = fbx.node("a");
  fbx.stack("walk", 1, 3);
  fbx.curve(fbx.layer(), a, "Lcl Translation", 'X', {{1, 3}, {0, 2}});
  fbx.stack("run", 11, 13);
  fbx.curve(fbx.layer(), a, "Lcl Translation", 'X', {{11, 13}, {0, 6}});
  SceneOptions options;
  options.take = "run";
  expect_track(x_track(fbx.write("takes.fbx"), "a", options), 11, {0, 3, 6});
  options.take = "walk";
  expect_track(x_track(fbx.write("takes.fbx"), "a", options), 1, {0, 1, 2});
}

TEST(SceneFbxUfbx, TheFirstFrameIsThatOfTheFileUnlessBlenderLostIt) {
  const Scene scene = read_scene(sample("S7_stacks.fbx"));
  EXPECT_EQ(scene.first_frame, 10);
  EXPECT_EQ(scene.last_frame, 34);
  EXPECT_EQ(scene.origin.at("first_frame"), "file");
  EXPECT_FALSE(has_warning(scene, "--start-frame"));
  // "All Actions": eight stacks from 0
  const Scene lost = read_scene(data / "S6_interp_default.fbx");
  EXPECT_EQ(lost.first_frame, 1);
  EXPECT_TRUE(has_warning(lost, "--start-frame"));
  const test::TrackError error = test::track_error(read_tracks(data / "S6_interp_default.fbx"),
                                                   data / "S6_interp.handles.csv");
  EXPECT_GT(error.motion, 0.03);
  EXPECT_LE(error.worst, 3.5e-4);  // Simplify, which is on by default
}

// With "All Actions" a scene of one object has one stack "object|action"; the stack of a scene has
// only the name of the scene.
TEST(SceneFbxUfbx, ASingleStackOfAnActionHasAlsoLostItsStart) {
  for (const std::string name : {"handle|lift", "Scene"}) {
    FbxFixture fixture;
    fixture.creator = "Blender (stable FBX IO) - 4.5.0 - 5.13.0";
    const std::int64_t node = fixture.node("handle");
    fixture.stack(name, 0, 5);
    fixture.curve(fixture.layer(), node, "Lcl Translation", 'X', {{0, 5}, {0, 1}});
    const Tracks tracks = read_tracks(fixture.write("one_stack.fbx"));
    EXPECT_EQ(tracks.first_frame, name == "Scene" ? 0 : 1) << name;
  }
}

TEST(SceneFbxUfbx, ThinnedOutCurvesAreWarnedOf) {
  EXPECT_TRUE(has_warning(read_scene(data / "S6_interp_default.fbx"), "export with Simplify 0"));
  EXPECT_FALSE(has_warning(read_scene(sample("S1_push.fbx")), "constraint"));
  const ImportedFile sparse =
      import_in_process(moved("sparse.fbx", {{1, 9, 20}, {0, 1, 3}}, 1, 20));
  EXPECT_TRUE(sparse.warnings.empty());
}

TEST(SceneFbxUfbx, ImplausiblyLongClipsAreErrors) {
  try {
    read_tracks(moved("endless.fbx", {{0, 5e6}, {0, 1}}, 0, 5e6));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("The clip runs from frame 0 to 5e+06"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace paperbake
