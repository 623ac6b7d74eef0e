// The custom properties paper_*: their types, and errors with node and key.

#include "formats/scene/scene_file.h"

#include "tests/formats/scene/scene_fixture.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

namespace paperbake {
namespace {

using test::grid;
using test::handle;
using test::has_warning;
using test::HeldSheet;

TEST(SceneProperties, UnknownPropertiesOnlyWarn) {
  const HeldSheet fixture(grid(2, 2, 0.2, 0.2), R"({"paper_uv":1})",
                          R"({"paper_colour":"red","paper_weight":1,"other":2})");
  const Scene scene = read_scene(fixture.write("unknown.gltf"));
  EXPECT_TRUE(has_warning(scene, "paper_colour of node \"handle.moved\""));
  EXPECT_FALSE(has_warning(scene, "paper_weight") || has_warning(scene, "paper_uv") ||
               has_warning(scene, "other"));
}

TEST(SceneProperties, NamesThatAreNearlyThoseOfAPartAreTold) {
  HeldSheet scene(grid(2, 2, 0.2, 0.2));
  const std::map<std::string, std::string> slips = {{"Colider", "collider"},
                                                    {"handel.1", "handle"},
                                                    {"rig:papier_2", "paper"},
                                                    {"crase", "crease"}};
  for (const auto& [name, role] : slips) scene.mesh(name, grid(1, 1, 0.1, 0.1));
  // other words, and one that is a collider by its property
  for (const char* name : {"candle", "Wine", "Window", "hand.2", "tape", "increase", "glass"})
    scene.mesh(name, grid(1, 1, 0.1, 0.1));
  scene.mesh("collide", grid(1, 1, 0.1, 0.1), R"({"paper_collider":true})");
  const Scene read = read_scene(scene.write("slips.gltf"));
  for (const auto& [name, role] : slips)
    EXPECT_TRUE(has_warning(read, fmt::format("\"{}\" has no part in the scene: should its name "
                                              "begin with \"{}\"?",
                                              name, role)))
        << name;
  EXPECT_EQ(std::count_if(read.warnings.begin(), read.warnings.end(),
                          [](const std::string& warning) {
                            return warning.find("has no part") != std::string::npos;
                          }),
            static_cast<long>(slips.size()));
}

TEST(SceneProperties, PropertiesAreReadWhateverTheirType) {
  const char* on_sheet =
      R"({"paper_gsm":"80","paper_seed":7,"paper_preset":"copy70","paper_fps":24,"paper_gravity":9.81,"paper_friction":"0.25"})";
  const char* on_handle =
      R"({"paper_grab_frame":2.0,"paper_release_frame":"4","paper_mode":"Relative","paper_radius":0,)"
      R"("paper_stiffness":50})";
  const Scene scene =
      read_scene(HeldSheet(grid(2, 2, 0.2, 0.2), on_sheet, on_handle).write("types.gltf"));
  const Handle& moved = handle(scene, "handle.moved");
  EXPECT_EQ(moved.grab_frame, 2);
  EXPECT_EQ(moved.release_frame, 4);
  EXPECT_EQ(moved.mode, HandleMode::relative);
  EXPECT_EQ(moved.radius, 0.0);
  EXPECT_EQ(moved.stiffness, 50);
  EXPECT_EQ(scene.sheets.at(0).grammage, 80.0);
  EXPECT_EQ(scene.sheets[0].friction, 0.25);
  EXPECT_EQ(scene.sheets[0].seed, 7u);
  EXPECT_EQ(scene.sheets[0].preset, "copy70");
  EXPECT_EQ(scene.gravity, 9.81);
  EXPECT_EQ(scene.origin.at("fps"), "paper_fps of \"paper\"");
  EXPECT_FALSE(has_warning(scene, "--fps"));
}

TEST(SceneProperties, AHandleThatNeverHoldsIsToldWithItsFrames) {
  const auto with = [](const char* extras) {
    return read_scene(HeldSheet(grid(2, 2, 0.2, 0.2), "{}", extras).write("never.gltf"));
  };
  EXPECT_TRUE(has_warning(with(R"({"paper_grab_frame":5,"paper_release_frame":3})"),
                          "never holds: it is released at frame 3 and grabbed at 5"));
  EXPECT_TRUE(has_warning(with(R"({"paper_release_frame":1})"),
                          "never holds: it is released at frame 1, and the scene begins at 1"));
  EXPECT_FALSE(has_warning(with(R"({"paper_release_frame":2})"), "never holds"));
}

TEST(SceneProperties, InvalidPropertiesAreErrorsWithNodeAndKey) {
  const auto sheet_with = [](const char* extras) {
    return HeldSheet(grid(2, 2, 0.2, 0.2), extras).write("bad.gltf");
  };
  EXPECT_ERROR(sheet_with(R"({"paper_friction":40})"), "paper_friction is 40");
  EXPECT_ERROR(sheet_with(R"({"paper_thickness":0.09})"),
               "bad.gltf, sheet \"paper\", paper_thickness\n  The thickness cannot be 0.09: paper "
               "lies between 5e-06 and 0.005 [m].\n  Give the value in m: 0.09 mm is 9e-05 m.");
  EXPECT_ERROR(sheet_with(R"({"paper_gsm":20000})"),
               "The grammage cannot be 20000: paper lies between 1 and 10000 [g/m2].");
  EXPECT_ERROR(sheet_with(R"({"paper_gsm":0})"), "The grammage cannot be 0");
  const auto with = [](const char* extras) {
    return HeldSheet(grid(2, 2, 0.2, 0.2), "{}", extras).write("bad.gltf");
  };
  EXPECT_ERROR(with(R"({"paper_mode":"sideways"})"), "paper_mode is \"sideways\"");
  EXPECT_ERROR(with(R"({"paper_grab_frame":"soon"})"),
               "node \"handle.moved\"\n  The property paper_grab_frame is \"soon\", not a number.");
  EXPECT_ERROR(with(R"({"paper_grab_frame":2.5})"), "not a whole number");
  EXPECT_ERROR(with(R"({"paper_radius":-1})"), "not zero or greater");
  EXPECT_ERROR(with(R"({"paper_point":"elbow"})"), "head or tail");
  EXPECT_ERROR(with(R"({"paper_target":"napkin"})"), "The sheets are: paper.");
}

TEST(SceneProperties, OfTheWholeSceneMustNotContradictEachOther) {
  const auto with = [](const char* on_sheet, const char* on_handle) {
    return HeldSheet(grid(2, 2, 0.2, 0.2), on_sheet, on_handle).write("whole.gltf");
  };
  EXPECT_ERROR(with(R"({"paper_fps":24})", R"({"paper_fps":30})"),
               "whole.gltf, nodes \"paper\" and \"handle.moved\"\n  paper_fps is 24 on the one and "
               "30 on the other");
  EXPECT_ERROR(with(R"({"paper_gravity":9.81})", R"({"paper_gravity":0})"),
               "paper_gravity is 9.81");
  EXPECT_ERROR(with(R"({"paper_air":0})", R"({"paper_air":1.2})"), "paper_air is 0");
  EXPECT_EQ(read_scene(with(R"({"paper_fps":24})", R"({"paper_fps":"24.0"})")).fps, 24);
  SceneOptions options;
  options.fps = 25;
  EXPECT_EQ(read_scene(with(R"({"paper_fps":24})", R"({"paper_fps":30})"), options).fps, 25)
      << "neither counts";
}

}  // namespace
}  // namespace paperbake
