// What paperbake inspect tells of a scene. Everything is checked from outside.

#include "baker/check/inspect_colliders.h"
#include "tests/baker/program_fixture.h"
#include "tests/core/test_meshes.h"
#include "tests/formats/scene/scene_fixture.h"

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

TEST_F(InspectTest, APaperThatThereIsNotEndsAsItsBakeDoes) {
  const auto scene = [](const char* extras) {
    return test::HeldSheet(test::grid(2, 2, 0.2, 0.2), extras).write("no_paper.gltf").string();
  };
  const std::string typo = scene(R"({"paper_preset":"copy7O"})"),
                    place = "no_paper.gltf, sheet \"paper\"";
  const auto both_refuse = [&](const std::string& path, const std::string& where,
                               const std::string& words) {
    EXPECT_TRUE(is_error(run({"inspect", path}), 3, where, words));
    EXPECT_TRUE(is_error(run({"bake", path, "--dry-run", "-o", folder / "none"}), 3, where, words));
  };
  both_refuse(typo, place + ", paper_preset", "Did you mean \"copy70\"?");
  EXPECT_EQ(run({"bake", typo, "--preset", "copy90", "--dry-run", "-o", folder / "none"}).code, 0)
      << "it is not used";
  both_refuse(scene(R"({"paper_gsm":8000})"), place, "The thickness cannot be");
}

TEST_F(InspectTest, WhatABakeWouldWarnOfIsToldBeforeIt) {
  test::GltfFixture scene;  // two sheets in one place, which fall
  scene.mesh("paper.a", test::grid(1, 1, 0.2, 0.2), R"({"paper_gravity":9.81})");
  scene.mesh("paper.b", test::grid(1, 1, 0.2, 0.2));
  const std::string file = scene.write("falls.gltf");
  const auto inspected = nlohmann::json::parse(run({"inspect", file, "--json"}).out);
  const Ended bake = run({"bake", file, "-o", output(), "--dry-run"});
  ASSERT_EQ(bake.code, 0) << bake.err;
  bool tells_frames = false, tells_sheets = false;
  for (const std::string warning : inspected.at("warnings")) {
    EXPECT_NE(bake.err.find(warning), std::string::npos) << warning;
    tells_frames |= warning.rfind("Frames 1-96 are baked", 0) == 0;
    tells_sheets |= warning.rfind("The sheets \"paper.a\" and \"paper.b\"", 0) == 0;
  }
  EXPECT_TRUE(tells_frames && tells_sheets) << inspected.at("warnings");
}

TEST_F(InspectTest, CollidersAreListedWithWhatTheyAreAndWhereTheSheetIs) {
  const Ended ended = run({"inspect", samples + "/F2_half.glb", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto colliders = nlohmann::json::parse(ended.out).at("colliders");
  ASSERT_GE(colliders.size(), 1u) << ended.out;
  for (const auto& collider : colliders) {
    EXPECT_GT(collider.at("triangles"), 0);
    EXPECT_TRUE(collider.at("closed").is_boolean());
    EXPECT_EQ(collider.at("nearest_sheet"), "paper");
    EXPECT_EQ(collider.at("sheets").at(0).at("sheet"), "paper");
    EXPECT_EQ(collider.at("sheets").at(0).at("side"), collider.at("closed") ? "outside" : "front");
    EXPECT_LT(std::abs(double(collider.at("distance_m"))), 1.0);
  }
  const std::string text = run({"inspect", samples + "/F2_half.glb"}).out;
  EXPECT_NE(text.find("collider \"" + colliders[0].at("name").get<std::string>() + "\": "),
            std::string::npos)
      << text;
  EXPECT_EQ(run({"inspect", samples + "/S1_push.glb"}).out.find("collider"), std::string::npos);
}

TEST_F(InspectTest, WindsAreListedWithTheirDirectionAndTheirGusts) {
  test::HeldSheet scene;
  scene.node("wind.side", {0, 0, 0}, R"({"paper_axis":"-x","paper_speed":2})");
  scene.scale(
      scene.node("wind.rises", {0, 0, 0}, R"({"paper_speed":4,"paper_gust":0.3,"paper_seed":7})"),
      {1, 5}, {0.25, 0.5});
  const std::string file = scene.write("winds.gltf");
  const auto winds = nlohmann::json::parse(run({"inspect", file, "--json"}).out).at("winds");
  ASSERT_EQ(winds.size(), 2u);
  EXPECT_EQ(winds[0].at("name"), "wind.side");
  EXPECT_NEAR(winds[0].at("first_velocity_m_per_s")[0].get<double>(), -2, 1e-6);
  EXPECT_EQ(winds[0].at("gust"), 0);
  EXPECT_NEAR(winds[1].at("first_velocity_m_per_s")[2].get<double>(), 2, 1e-6);
  EXPECT_NEAR(winds[1].at("least_speed_m_per_s").get<double>(), 2, 1e-6);
  EXPECT_NEAR(winds[1].at("most_speed_m_per_s").get<double>(), 4, 1e-6);
  EXPECT_EQ(winds[1].at("gust"), 0.3);
  EXPECT_EQ(winds[1].at("seed"), 7);
  const std::string text = run({"inspect", file}).out;
  EXPECT_NE(text.find("wind \"wind.side\": (-2.000, 0.000, 0.000) m/s in the first frame, speed 2 "
                      "m/s\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("speed 2 to 4 m/s; gusts of 30 % (seed 7)\n"), std::string::npos) << text;
  EXPECT_EQ(run({"inspect", samples + "/S1_push.glb"}).out.find("wind"), std::string::npos);
}

/// The crease lines of the only sheet, by number.
nlohmann::json creases(const Ended& inspected) {
  return nlohmann::json::parse(inspected.out).at("sheets").at(0).at("creases");
}

TEST_F(InspectTest, TheFoldsOfALetterAreListedBeforeTheBake) {
  const nlohmann::json lines = creases(run({"inspect", samples + "/F1_letter.glb", "--json"}));
  ASSERT_EQ(lines.size(), 2u);
  constexpr double height[] = {0.096, 0.198}, turn[] = {177.5, 165};
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(lines[k].at("id"), k + 1);
    EXPECT_EQ(lines[k].at("expected"), true);
    EXPECT_NEAR(std::abs(lines[k].at("angle_deg").get<double>()), turn[k], 1e-3);
    ASSERT_EQ(lines[k].at("line_m").size(), 2u);
    double ends[2];
    for (std::size_t end = 0; end < 2; ++end) {
      ends[end] = lines[k]["line_m"][end][0];
      EXPECT_NEAR(lines[k]["line_m"][end][1].get<double>(), height[k], 1e-6);
    }
    EXPECT_NEAR(std::min(ends[0], ends[1]), 0, 1e-6);
    EXPECT_NEAR(std::max(ends[0], ends[1]), 0.210, 1e-6);
    const std::string from = lines[k].at("from");
    EXPECT_EQ(from.find("clamps"), 0u) << from;
    EXPECT_NE(from.find(k == 0 ? "handle.bottom.0" : "handle.top.0"), from.npos) << from;
    EXPECT_NE(from.find("handle.middle.0"), from.npos) << from;
  }
  EXPECT_NE(run({"inspect", samples + "/F1_letter.glb"})
                .out.find("crease 1 from (0.00, 96.00) to (210.00, 96.00) mm, expected"),
            std::string::npos);
}

TEST_F(InspectTest, TheFourFoldsOfAFanTurnToBothSides) {
  const nlohmann::json lines = creases(run({"inspect", samples + "/F4_fan.glb", "--json"}));
  std::map<int, double> turn;  // by place [mm]
  for (const auto& line : lines)
    turn[std::lround(1e3 * line.at("line_m").at(0).at(0).get<double>())] = line.at("angle_deg");
  ASSERT_EQ(turn.size(), 4u);
  double sign = 1;
  for (const int place : {32, 64, 96, 128}) {
    ASSERT_TRUE(turn.count(place)) << place;
    EXPECT_NEAR(turn[place], 160 * sign, 1e-3) << place;
    sign = -sign;
  }
}

TEST_F(InspectTest, HandlesOfDifferentHandsThatMoveAlikeForAWhileFoldNothing) {
  // a sheet is doubled, then its corners are folded down, the right one of each layer a little
  // later: for a while two of its handles near the line are a plate with one beyond the line
  const std::string boat = PAPERBAKE_DATA "/violent/folded_boat.glb";
  EXPECT_EQ(creases(run({"inspect", boat, "--json"})).size(), 5u);
}

TEST_F(InspectTest, WhereNothingIsGoingToFoldNoCreaseIsListed) {
  EXPECT_EQ(creases(run({"inspect", samples + "/S1_push.glb", "--json"})), nlohmann::json::array());
  EXPECT_EQ(run({"inspect", samples + "/S1_push.glb"}).out.find("crease"), std::string::npos);
}

TEST_F(InspectTest, ACreaseThatIsDrawnSaysWhatItSpringsBackTo) {
  const nlohmann::json lines =
      creases(run({"inspect", PAPERBAKE_SAMPLES "/../tests/data/creases.glb", "--json"}));
  ASSERT_FALSE(lines.empty());
  for (const auto& line : lines) EXPECT_EQ(line.at("expected"), false) << line;
  EXPECT_EQ(lines[0].at("from"), "\"crease.drawn\"");
  EXPECT_NEAR(lines[0].at("angle_deg").get<double>(), -20, 1e-4);
}

TEST(InspectedCollidersTest, TheDistanceIsThatOfTheNearestPointsAlsoBetweenVertices) {
  Scene scene;
  Points2 corners(4, 2);
  corners << 0, 0, 0.1, 0, 0.1, 0.1, 0, 0.1;
  Triangles halves(2, 3);
  halves << 0, 1, 2, 0, 2, 3;
  scene.sheets.emplace_back();
  scene.sheets[0].start = test::flat_sheet(corners, halves);
  // the edge of a roof, 2 mm above the sheet and across it
  ColliderMesh roof{"roof", Points3(4, 3), Triangles(2, 3), {}};
  roof.x << -0.05, 0.0437, 0.002, 0.15, 0.0519, 0.002, 0.05, 0.02, 0.04, 0.05, 0.07, 0.04;
  roof.triangles << 0, 1, 3, 1, 0, 2;
  scene.colliders = {roof};
  EXPECT_NEAR(inspected_colliders(scene)[0].nearest().distance, 0.002, 1e-9);
  // all its edges keep their lengths when it folds along the one between its triangles
  EXPECT_STREQ(inspected_colliders(scene)[0].motion, "stands still");
  Points3 folded = roof.x;
  const Vector3d ridge = (roof.x.row(1) - roof.x.row(0)).normalized();
  const Eigen::AngleAxisd about(0.3, ridge);
  folded.row(2) = roof.x.row(0) + (about * (roof.x.row(2) - roof.x.row(0)).transpose()).transpose();
  scene.colliders[0].frames.own() = {roof.x, folded};
  EXPECT_STREQ(inspected_colliders(scene)[0].motion, "deforms");
  scene.colliders[0].frames.own() = {roof.x, roof.x * about.toRotationMatrix().transpose()};
  EXPECT_STREQ(inspected_colliders(scene)[0].motion, "moves");
}

}  // namespace
}  // namespace paperbake
