// What a bake leaves in its output folder and says of it. Everything is checked from outside.

#include "tests/baker/program_fixture.h"
#include "tests/formats/files/frame_keys.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::CommandLine;
using test::Ended;
using test::fields_of;
using test::is_error;
using test::lines_of;
using test::read;
using test::samples;
using test::Words;
using test::write;
using BakeCommandTest = test::CommandLine;

using Record = nlohmann::json;
std::vector<Record> frames_of(const fs::path& folder) {
  std::vector<Record> frames;
  for (const std::string& line : lines_of(read(folder / "cert" / "frames.jsonl")))
    frames.push_back(Record::parse(line));
  return frames;
}

class BakeTest : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    ended = run(job("S4_crumple.glb", output(), "1-6"));
    ASSERT_EQ(ended.code, 0) << ended.err;
  }
  static Words job(const std::string& scene, const std::string& folder, const std::string& frames) {
    return {"bake",        samples + "/" + scene,
            "-o",          folder,
            "--method",    "fem",
            "--triangles", "200",
            "--frames",    frames,
            "--map-size",  "64"};
  }
  std::string text(const char* file) const { return read(fs::path(output()) / file); }

  Ended ended{};
};

TEST_F(BakeTest, TheOutputFolderHasAllDocumentedFilesAndNoUnfinishedOne) {
  std::set<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(output()))
    if (entry.is_regular_file())
      found.insert(fs::relative(entry.path(), output()).generic_string());
  for (const char* file : {"S4_crumple.abc", "maps/S4_crumple.0001.exr",
                           "maps/S4_crumple.final.exr", "cert/frames.jsonl", "cert/handles.csv",
                           "cert/summary.json", "singular.csv", "job.lock.toml"})
    EXPECT_TRUE(found.count(file)) << file;
  for (const std::string& file : found) {
    EXPECT_EQ(file.find(".part"), std::string::npos) << file;
    const bool wanted_map =
        file == "maps/S4_crumple.0001.exr" || file == "maps/S4_crumple.final.exr";
    EXPECT_TRUE(wanted_map || file.rfind("maps/", 0) != 0) << file << " is one map too many";
  }
}

TEST_F(BakeTest, TheSummarySaysOfEveryModelWhetherItIsOnAndWhy) {
  const Record models = Record::parse(text("cert/summary.json"))["models"];
  for (const char* key : {"dynamics", "gravity", "plasticity", "singular_points", "contact",
                          "layers_apart", "colliders", "polish", "between_sheets"}) {
    ASSERT_TRUE(models.contains(key)) << key;
    EXPECT_FALSE(models[key]["on"].get<bool>()) << key;
    EXPECT_GT(models[key]["why"].get<std::string>().size(), 5u) << key;
  }
  EXPECT_NE(models["dynamics"]["why"].get<std::string>().find("handles hold the sheet"),
            std::string::npos);
  EXPECT_EQ(models["colliders"]["why"], "none in scene");
}

TEST_F(BakeCommandTest, ASheetThatIsLetGoUnderGravityIsBakedWithInertia) {
  const Ended ended = run({"bake", samples + "/S9_unload.glb", "-o", output(), "--gravity", "9.81",
                           "--frames", "58-64", "--formats", "cert"});
  ASSERT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  const Record models = Record::parse(read(fs::path(output()) / "cert" / "summary.json"))["models"];
  EXPECT_TRUE(models["dynamics"]["on"].get<bool>());
  EXPECT_NE(models["dynamics"]["why"].get<std::string>().find("from frame 61 on: it swings"),
            std::string::npos)
      << models["dynamics"];
  EXPECT_NE(read(fs::path(output()) / "job.lock.toml").find("dynamics = \"on\"  # auto"),
            std::string::npos);
}

TEST_F(BakeTest, FilesArePrintedOnStdoutAndFramesOnStderr) {
  const std::vector<std::string> files = lines_of(ended.out);
  EXPECT_FALSE(files.empty());
  for (const std::string& file : files) EXPECT_TRUE(fs::exists(file)) << file;
  EXPECT_NE(ended.err.find("frame 6"), std::string::npos) << ended.err;
}

TEST_F(BakeTest, EveryFrameHasALineWithAllDocumentedKeysInTheirOrder) {
  const std::vector<std::string> lines = lines_of(text("cert/frames.jsonl"));
  ASSERT_EQ(lines.size(), 6u);
  std::set<std::string> contents;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = nlohmann::ordered_json::parse(lines[i]);
    std::vector<std::string> found;
    for (const auto& [key, value] : line.items()) found.push_back(key);
    EXPECT_EQ(found, test::frame_keys);
    EXPECT_EQ(line["frame"], i + 1);
    EXPECT_EQ(line["sheet"], "paper");
    EXPECT_NEAR(line["triangles"], 200, 20);
    contents.insert(line["content_hash"]);
  }
  EXPECT_EQ(contents.size(), 6u) << "the sheet moves, so no two frames are alike";
}

TEST_F(BakeTest, EveryHandleHasARowInEveryFrame) {
  const std::vector<std::string> rows = lines_of(text("cert/handles.csv"));
  EXPECT_EQ(rows.at(0),
            "frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state");
  const auto handles = nlohmann::json::parse(
      run({"inspect", samples + "/S4_crumple.glb", "--json"}).out)["sheets"][0]["handles"];
  EXPECT_EQ(rows.size(), 1 + 6 * handles.size());
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto row = fields_of(rows[i]);
    ASSERT_EQ(row.size(), 12u) << rows[i];
    EXPECT_TRUE(row[11] == "held" || row[11] == "free" || row[11] == "jammed") << rows[i];
    for (int axis = 0; axis < 3 && row[11] == "held"; ++axis)
      EXPECT_NEAR(std::stod(row[5 + axis]), std::stod(row[8 + axis]), 1e-9) << rows[i];
  }
}

TEST_F(BakeTest, TheSummaryAgreesWithTheFrames) {
  const auto summary = nlohmann::json::parse(text("cert/summary.json"));
  EXPECT_EQ(summary.at("exit_code"), ended.code);
  EXPECT_EQ(summary.at("frames"), 6);
  EXPECT_EQ(summary.at("method"), "fem");
  for (const char* key : {"version", "settings", "machine", "models", "job_hash", "sheets"})
    EXPECT_TRUE(summary.contains(key)) << key;
  for (const char* key :
       {"stretch_mean_pct", "stretch_max_pct", "handle_err_max_mm", "angle_defect_max_deg"}) {
    double largest = 0;
    for (const Record& frame : frames_of(output())) largest = std::max(largest, double(frame[key]));
    EXPECT_DOUBLE_EQ(summary[key].at("max"), largest) << key;
  }
  EXPECT_GT(double(summary["stretch_mean_pct"]["max"]), 0);
}

TEST_F(BakeTest, SingularPointsAndTheOriginOfEveryValueAreListed) {
  EXPECT_EQ(lines_of(text("singular.csv")).at(0), "id,sheet,frame,u,v,cause");
  const std::string lock = text("job.lock.toml");
  for (const char* line : {"triangles = 200  # command line", "method = \"fem\"  # command line",
                           "frames = \"1-6x1\"  # command line", "seed = 0  # default"})
    EXPECT_NE(lock.find(line), std::string::npos) << line << " is not in\n" << lock;
}

TEST_F(BakeTest, BakingEverySecondFrameGivesEverySecondFrameOfTheWholeBake) {
  std::map<int, std::string> whole;
  for (const Record& frame : frames_of(output())) whole[frame["frame"]] = frame["content_hash"];
  const fs::path other = folder / "sparse";
  ASSERT_EQ(run(job("S4_crumple.glb", other, "2-6x2")).code, 0);
  std::vector<int> frames;
  for (const Record& frame : frames_of(other)) {
    frames.push_back(frame["frame"]);
    EXPECT_EQ(frame["content_hash"], whole[frames.back()])
        << "the same frame, whichever others are written";
  }
  EXPECT_EQ(frames, (std::vector<int>{2, 4, 6}));
}

TEST_F(BakeCommandTest, ABakeInWhichOneSheetPassesThroughAnotherMissesAGate) {
  test::GltfFixture scene;
  for (const bool falls : {false, true}) {
    // tilted by 15 mm to either side, as it was modelled: what is above stays above
    const Vector3d up(0, 0, falls ? 0.0105 : 0.0);
    scene.mesh(falls ? "paper_b" : "paper_a",
               test::grid(2, 2, 0.1, 0.1, nullptr, [&](double u, double v) {
                 return Vector3d(up + Vector3d(u, v, falls ? 0.3 * (u - 0.05) : 0));
               }));
    for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(0.1, 0, 0), Vector3d(0, 0.1, 0)}) {
      const Vector3d from = at + up + Vector3d(0, 0, falls ? 0.3 * (at.x() - 0.05) : 0);
      scene.move(scene.node(fmt::format("handle_{}{}{}", falls, at.x(), at.y()), from,
                            fmt::format(R"({{"paper_target":"paper_{}"}})", falls ? 'b' : 'a')),
                 {0, 39}, {from, falls ? Vector3d(from - Vector3d(0, 0, 0.039)) : from});
    }
  }
  const Ended ended = run({"bake", scene.write("through.gltf"), "-o", output(), "--method", "fem",
                           "--triangles", "100", "--formats", "cert", "--progress", "plain"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_NE(ended.err.find(" pairs of triangles of two sheets pass through each other"),
            std::string::npos)
      << ended.err;
  for (const Record& frame : frames_of(output()))
    EXPECT_EQ(frame["note"] == "passes through another sheet",
              frame["sheet"] == "paper_b" && frame["crossings_with_others"] > 0)
        << frame;
}

TEST_F(BakeCommandTest, ASoftHandleThatLagsMissesNoGateAndIsNoReasonForAnotherTake) {
  test::GltfFixture scene;
  scene.mesh("paper", test::grid(2, 2, 0.1, 0.1, nullptr,
                                 [](double u, double v) { return Vector3d(u, v, 0); }));
  for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(0, 0.1, 0)})
    scene.node(fmt::format("handle_{}", at.y()), at);
  const Vector3d from(0.1, 0.05, 0);
  scene.move(scene.node("handle_soft", from, R"({"paper_stiffness":40})"), {0, 9},
             {from, Vector3d(from + Vector3d(0.02, 0, 0))});
  const Ended ended = run({"bake", scene.write("soft.gltf"), "-o", output(), "--formats",
                           "abc,cert", "--progress", "none"});
  EXPECT_EQ(ended.code, 0) << ended.err
                           << "paper is 20 mm too short for it, but a spring gives way";
  EXPECT_LT(frames_of(output()).back()["handle_err_max_mm"], 0.1) << "of the hard handles";
  EXPECT_TRUE(
      Record::parse(read(fs::path(output()) / "cert/summary.json")).at("attempts").is_null());
  for (const std::string& row : lines_of(read(fs::path(output()) / "cert/handles.csv")))
    EXPECT_EQ(row.find("handle_soft") != std::string::npos, fields_of(row).back() == "soft") << row;
  EXPECT_EQ(run({"verify", output()}).code, 0) << "from the files alone";
}

TEST_F(BakeCommandTest, TheHybridBeginsWithNoMoreTrianglesThanItMayHave) {
  const auto bake_with = [&](const Words& more) {
    Words words{"bake",       samples + "/S8_dcone.glb",
                "-o",         output(),
                "--frames",   "1-2",
                "--formats",  "cert",
                "--progress", "none"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  ASSERT_EQ(bake_with({"--triangles", "80"}).code, 0);
  for (const Record& frame : frames_of(output()))
    EXPECT_LT(frame["triangles"], 110) << "about 80, and what handles take";
  ASSERT_EQ(bake_with({"--base-triangles", "300"}).code, 0);
  for (const Record& frame : frames_of(output())) EXPECT_GT(frame["triangles"], 250);
  EXPECT_TRUE(is_error(bake_with({"--base-triangles", "300", "--triangles", "200"}), 2,
                       "--base-triangles 300", "no more than 200"));
}

TEST_F(BakeTest, TheWholeShotHasOneRenderMeshAsFineAsTheQualitySays) {
  const auto triangles = [](const std::vector<Record>& frames) {
    std::set<int> all;
    for (const Record& frame : frames) all.insert(int(frame["render_triangles"]));
    return all;
  };
  const auto shot = triangles(frames_of(output()));
  ASSERT_EQ(shot.size(), 1u);
  // of the square sheet, with edges of a hundredth of its side
  const double equilateral = 2 / (std::sqrt(0.75) * 0.01 * 0.01);
  EXPECT_NEAR(*shot.begin(), equilateral, 0.1 * equilateral);
  for (const Record& frame : frames_of(output())) {
    EXPECT_GT(double(frame["render_ms"]), 0);
    EXPECT_EQ(frame["render_crossings"], 0);
    EXPECT_LT(double(frame["render_stretch_mean_pct"]), 0.3);
    EXPECT_NE(frame["render_stretch_mean_pct"], frame["stretch_mean_pct"]);
  }
  const fs::path draft = folder / "draft", hero = folder / "hero",
                 simulation = folder / "simulation";
  const auto bake_with = [&](const fs::path& to, const Words& more) {
    Words words = job("S4_crumple.glb", to, "1-2");
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(run(words).code, 0);
    return frames_of(to);
  };
  EXPECT_NEAR(*triangles(bake_with(draft, {"--quality", "draft"})).begin(), equilateral / 6.25,
              0.1 * equilateral / 6.25);
  EXPECT_EQ(*triangles(bake_with(hero, {"--quality", "hero"})).begin(),
            4 * *triangles(bake_with(folder / "two", {})).begin());
  for (const Record& frame : bake_with(simulation, {"--mesh", "simulation"})) {
    EXPECT_EQ(frame["render_triangles"], frame["triangles"]);
    // of positions in 32 bits
    EXPECT_NEAR(frame["render_stretch_mean_pct"], double(frame["stretch_mean_pct"]), 1e-4);
    EXPECT_EQ(frame["render_ms"], 0);
  }
}

TEST_F(BakeCommandTest, EveryLineSaysHowFarTheSheetAndWhatDrivesItHaveMoved) {
  // until it is touched the sheet rests in a sphere that shrinks by 1 mm a frame
  for (const int step : {1, 3}) {
    const std::string frames = "1-7x" + std::to_string(step);
    ASSERT_EQ(run({"bake", samples + "/S12_sphere.glb", "-o", output(), "--frames", frames,
                   "--formats", "cert", "--mesh", "simulation"})
                  .code,
              0);
    for (const Record& line : frames_of(output())) {
      const bool is_first = line["frame"] == 1;
      EXPECT_NEAR(line["driven_mm"], is_first ? 0 : step, 0.01) << line["frame"];
      EXPECT_LT(line["moved_mm"], 1e-3) << line["frame"];
    }
  }
}

TEST_F(BakeCommandTest, WindDrivesASheetWithInertiaAlone) {
  for (const bool inertia : {true, false}) {
    ASSERT_EQ(run({"bake", samples + "/S1_push.glb", "-o", output(), "--frames", "1-3", "--formats",
                   "cert", "--mesh", "simulation", "--wind", "2.4,0,0", "--dynamics",
                   inertia ? "on" : "off"})
                  .code,
              0);
    for (const Record& line : frames_of(output())) {
      if (line["frame"] == 1) continue;
      const double driven = line["driven_mm"];
      EXPECT_EQ(std::abs(driven - 2400 / 24.0) < 0.01, inertia) << driven;
    }
  }
}

TEST_F(BakeTest, ASheetThatHandlesDriveMoves) {
  for (const Record& line : frames_of(output())) {
    const bool is_first = line["frame"] == 1;
    EXPECT_EQ(line["driven_mm"] > 0, !is_first) << line["frame"];
    EXPECT_EQ(line["moved_mm"] > 0, !is_first) << line["frame"];
  }
}

TEST_F(BakeTest, ASecondBakeReplacesTheFilesOfTheFirstByWholeOnes) {
  const std::string before = text("S4_crumple.abc");
  write(fs::path(output()) / "notes.txt", "of the artist");
  ASSERT_EQ(run(job("S4_crumple.glb", output(), "1-6")).code, 0);
  EXPECT_EQ(text("S4_crumple.abc"), before);
  EXPECT_EQ(text("notes.txt"), "of the artist");
}

TEST_F(BakeTest, AnFbxBakesLikeTheSameSceneAsGlb) {
  const fs::path other = folder / "fbx";
  Words words = job("S4_crumple.fbx", other, "1-6");
  words.insert(words.end(), {"--start-frame", "1"});
  ASSERT_EQ(run(words).code, 0);
  const auto held = [](const std::string& csv) {
    std::map<std::string, double> z;
    for (const std::string& line : lines_of(csv))
      if (const auto row = fields_of(line); row.at(11) == "held")
        z[row[0] + " " + row[2]] = std::stod(row[10]);
    return z;
  };
  const auto glb = held(text("cert/handles.csv")), fbx = held(read(other / "cert" / "handles.csv"));
  ASSERT_EQ(glb.size(), fbx.size());
  ASSERT_GT(glb.size(), 20u);
  // the FBX keeps its keys a little coarser
  for (const auto& [key, z] : glb) EXPECT_NEAR(fbx.at(key), z, 2e-4) << key;
}

}  // namespace
}  // namespace paperbake
