// Axes, unit, frame rate and names of FBX files: sample scenes with a few bytes changed.

#include "formats/scene/scene_file.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>

namespace paperbake {
namespace {

using test::handle;
using test::sample;
using test::temporary;
using test::whole;

/// Sets a property of a binary FBX file, whose name is followed by three strings (type, label,
/// flags) and the value.
template <class Value>
void set_fbx(std::string& fbx, const std::string& name, Value value) {
  std::size_t at = fbx.find(std::string("S") + char(name.size()) + std::string(3, '\0') + name);
  ASSERT_NE(at, std::string::npos) << name;
  for (int strings = 0; strings < 4; ++strings) at += 5 + static_cast<unsigned char>(fbx[at + 1]);
  std::memcpy(&fbx[at + 1], &value, sizeof value);
}

TEST(SceneFbx, AxesAreThoseOfTheFile) {
  std::string fbx = whole(sample("S1_push.fbx"));
  // declared as z up: now the numbers of the file are those of the world, but for the unit
  set_fbx(fbx, "UpAxis", 2);
  set_fbx(fbx, "FrontAxis", 1);
  set_fbx(fbx, "FrontAxisSign", -1);
  const Tracks y_up = read_tracks(sample("S1_push.fbx")),
               z_up = read_tracks(temporary("z_up.fbx", fbx));
  const std::size_t middle =
      std::find(y_up.names.begin(), y_up.names.end(), "handle.mid.0") - y_up.names.begin();
  const Eigen::RowVector3d y = y_up.positions.at(middle).row(59),
                           z = z_up.positions.at(middle).row(59);
  ASSERT_NEAR(y.z(), -0.0199, 1e-4);
  EXPECT_NEAR((z - Eigen::RowVector3d(y.x(), y.z(), -y.y())).norm(), 0, 1e-12);
}

TEST(SceneFbx, UnitIsThatOfTheFile) {
  std::string fbx = whole(sample("S1_push.fbx"));
  set_fbx(fbx, "UnitScaleFactor", 2.0);
  const Tracks tracks = read_tracks(temporary("unit.fbx", fbx));
  const std::size_t right =
      std::find(tracks.names.begin(), tracks.names.end(), "handle.right.0") - tracks.names.begin();
  EXPECT_NEAR(tracks.positions.at(right)(0, 0), 0.2, 1e-6);
  set_fbx(fbx, "UnitScaleFactor", 100.0);
  EXPECT_ERROR(temporary("metres.fbx", fbx),
               "The file is probably in centimetres: bake with --unit-scale 0.01");
}

TEST(SceneFbx, RateIsThatOfTheFile) {
  std::string fbx = whole(sample("S1_push.fbx"));
  set_fbx(fbx, "TimeMode", 9);  // NTSC
  EXPECT_DOUBLE_EQ(read_scene(temporary("ntsc.fbx", fbx)).fps, 30000.0 / 1001);
  set_fbx(fbx, "TimeMode", 14);
  set_fbx(fbx, "CustomFrameRate", 12.0);
  SceneOptions options;
  options.start_frame = 1;
  const Scene slow = read_scene(temporary("custom.fbx", fbx), options);
  EXPECT_DOUBLE_EQ(slow.fps, 12);
  // 59 frames at 24 are 29.5 at 12, counted from frame 1 or from 0.5, which becomes 0
  EXPECT_NEAR(slow.last_frame, 31, 1);
}

TEST(SceneFbx, DuplicateNamesAreErrors) {
  std::string fbx = whole(sample("S7_stacks.fbx"));
  for (std::size_t at; (at = fbx.find("corner.1")) != std::string::npos;) fbx[at + 7] = '0';
  EXPECT_ERROR(temporary("twice.fbx", fbx), "handle \"handle.corner.0\"\n  Two handles");
}

TEST(SceneFbx, KeyedScaleReleasesWithoutTheProperty) {
  for (const char* extension : {".fbx", ".glb"}) {
    std::string file = whole(sample(std::string("S3_unload") + extension));
    for (std::size_t at; (at = file.find("paper_release_frame")) != std::string::npos;)
      file.replace(at, 5, "other");
    const Scene scene = read_scene(temporary(std::string("unnamed_release") + extension, file));
    EXPECT_EQ(handle(scene, "handle.left.5").release_frame, 61) << extension;
    EXPECT_TRUE(scene.sheets.at(0).scale_releases.count("handle.left.5")) << extension;
    EXPECT_FALSE(scene.sheets[0].scale_releases.count("handle.left.0")) << extension;
    EXPECT_TRUE(handle(scene, "handle.left.0").held(96)) << extension;
  }
}

}  // namespace
}  // namespace paperbake
