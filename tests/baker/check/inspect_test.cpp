// What paperbake inspect tells of a scene. Everything is checked from outside.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using InspectTest = test::CommandLine;
using test::Ended;
using test::fields_of;
using test::lines_of;
using test::read;
using test::samples;

TEST_F(InspectTest, TheTracksOfAnInspectionAreWhereTheDccHasTheHandles) {
  const fs::path csv = folder / "tracks.csv";
  ASSERT_EQ(run({"inspect", samples + "/S1_push.glb", "--tracks", csv}).code, 0);
  const std::vector<std::string> tracks = lines_of(read(csv)),
                                 truth = lines_of(read(samples + "/S1_push.handles.csv"));
  EXPECT_EQ(tracks.at(0), "frame,node,x,y,z");
  std::map<std::string, std::vector<std::string>> found;  // by frame and node
  for (std::size_t i = 1; i < tracks.size(); ++i) {
    const auto row = fields_of(tracks[i]);
    EXPECT_TRUE(found.emplace(row.at(0) + " " + row.at(1), row).second)
        << tracks[i] << " is there twice";
  }
  int compared = 0;
  double moved = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const auto row = fields_of(truth[i]);
    const auto track = found.find(row.at(0) + " " + row.at(1));
    ASSERT_NE(track, found.end()) << truth[i];
    for (int axis = 2; axis < 5; ++axis) {
      // keys are 32-bit floats
      EXPECT_NEAR(std::stod(track->second.at(axis)), std::stod(row.at(axis)), 1e-6) << truth[i];
      moved = std::max(moved, std::abs(std::stod(row.at(axis)) -
                                       std::stod(found.at("1 " + row.at(1)).at(axis))));
    }
    ++compared;
  }
  EXPECT_EQ(compared, 60 * 23);
  EXPECT_GT(moved, 0.01);
}

TEST_F(InspectTest, AnInspectionAsJsonSaysWhatIsInTheScene) {
  const Ended ended = run({"inspect", samples + "/S1_push.glb", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto scene = nlohmann::json::parse(ended.out);
  EXPECT_EQ(scene.at("first_frame"), 1);
  EXPECT_EQ(scene.at("last_frame"), 60);
  EXPECT_EQ(scene.at("fps"), 24);
  ASSERT_EQ(scene.at("sheets").size(), 1u);
  const auto& sheet = scene["sheets"][0];
  EXPECT_EQ(sheet.at("name"), "paper");
  EXPECT_NEAR(sheet.at("width_m"), 0.1, 1e-6);
  EXPECT_NEAR(sheet.at("height_m"), 0.1, 1e-6);
  EXPECT_EQ(sheet.at("handles").size(), 23u);
  for (const auto& handle : sheet["handles"])
    EXPECT_EQ(handle.at("mode"), handle.at("name") == "handle.mid.0" ? "relative" : "absolute")
        << handle;
}

}  // namespace
}  // namespace paperbake
