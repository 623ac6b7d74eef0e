// What the built program does with words: exit codes, messages, names of files. Everything is checked from outside.

#include "tests/gltf_fixture.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <spawn.h>
#include <sstream>
#include <string>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

extern char** environ;

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const std::string samples = PAPERBAKE_SAMPLES;

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.is_open()) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

struct Ended {
  int code;  // -1: it did not exit by itself
  std::string out, err;
};

/// Runs paperbake as a shell would, in the test's own folder.
Ended paperbake(const fs::path& folder, const Words& words) {
  const std::string out = folder / "stdout.txt", err = folder / "stderr.txt";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  std::vector<char*> arguments{const_cast<char*>(PAPERBAKE_PROGRAM)};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed = posix_spawn(&child, PAPERBAKE_PROGRAM, &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(failed, 0) << PAPERBAKE_PROGRAM << " cannot be started";
  int status = 0;
  if (failed || waitpid(child, &status, 0) != child) return {-1, "", ""};
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
}

/// paperbake: PLACE, then at least one indented line and nothing else; nothing on stdout.
testing::AssertionResult is_error(const Ended& ended, int code, const std::string& place, const std::string& cause) {
  const auto fails = [&](const std::string& why) {
    return testing::AssertionFailure() << why << "\nexit code " << ended.code << "\nstdout: " << ended.out << "\nstderr: " << ended.err;
  };
  const std::vector<std::string> lines = lines_of(ended.err);
  if (ended.code != code) return fails(fmt::format("exit code {} expected", code));
  if (!ended.out.empty()) return fails("an error belongs on stderr alone");
  if (lines.size() < 2 || lines.size() > 3) return fails("two or three lines expected: place, cause, remedy");
  if (lines[0].rfind("paperbake: " + place, 0) != 0) return fails("the first line should begin with: paperbake: " + place);
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (lines[i].rfind("  ", 0) != 0 || lines[i].size() < 4) return fails("not an indented line: " + lines[i]);
  if (lines[1].find(cause) == std::string::npos) return fails("the cause should name: " + cause);
  return testing::AssertionSuccess();
}

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) / fmt::format("paperbake_command_line_{}", getpid());
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  Ended run(const Words& words) const { return paperbake(folder, words); }

  /// A bake that ends in no time, with more words behind.
  Ended bake(const Words& more, const std::string& scene = samples + "/S4_crumple.glb") const {
    Words words{"bake", scene, "-o", output(), "--triangles", "100", "--frames", "1-2", "--map-size", "8", "--progress", "none"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }

  std::string output() const { return folder / "out" / "shot"; }

  /// A sheet of 10 cm whose two lower corners are drawn apart, evenly, to `factor` times their distance in frames 1-13.
  fs::path drawn_apart(double factor) const {
    test::GltfFixture scene;
    scene.mesh("paper", test::grid(1, 1, 0.1, 0.1));
    scene.node("handle.still", {0, 0, 0});
    scene.move(scene.node("handle.drawn", {0.1, 0, 0}), {1, 13}, {{0.1, 0, 0}, {0.1 * factor, 0, 0}});
    return scene.write(folder.filename() / "drawn_apart.gltf");
  }

  fs::path folder;
};

TEST_F(CommandLine, WithoutACommandItEndsWithTwo) {
  EXPECT_TRUE(is_error(run({}), 2, "command line", "subcommand"));
  EXPECT_TRUE(is_error(run({"bake"}), 2, "command line", "SCENE"));
  EXPECT_TRUE(is_error(run({"bake", samples + "/S4_crumple.glb"}), 2, "command line", "--output"));
}

TEST_F(CommandLine, AnUnknownOptionEndsWithTwoAndIsNamed) {
  EXPECT_TRUE(is_error(bake({"--colour", "red"}), 2, "command line", "--colour"));
  EXPECT_TRUE(is_error(bake({"--stop", "soon"}), 2, "command line", "soon"));
  EXPECT_TRUE(is_error(run({"bake", "scene.glb", "-o", output(), "--progress", "loud"}), 2, "command line", "loud"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLine, HelpAndVersionAreNoErrors) {
  const Ended help = run({"bake", "--help"}), version = run({"--version"});
  EXPECT_EQ(help.code, 0);
  for (const char* option : {"--preset", "--method", "--seed", "--triangles", "--gravity", "--frames", "--strict", "--dry-run"})
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
  EXPECT_EQ(version.code, 0);
  EXPECT_TRUE(std::regex_match(version.out, std::regex("paperbake [0-9]+\\.[0-9]+\\.[0-9]+\n"))) << version.out;
}

TEST_F(CommandLine, AMissingSceneEndsWithThree) {
  const std::string scene = folder / "nowhere.glb";
  EXPECT_TRUE(is_error(bake({}, scene), 3, scene, "no such file"));
  EXPECT_TRUE(is_error(run({"inspect", scene}), 3, scene, "no such file"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLine, ATextRenamedToFbxIsNoScene) {
  const std::string scene = folder / "letter.fbx";
  write(scene, "Dear artist,\nthis is no scene.\n");
  EXPECT_TRUE(is_error(bake({}, scene), 3, scene, ""));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLine, AnUnknownPresetEndsWithTwoAndTheNearestName) {
  EXPECT_TRUE(is_error(bake({"--preset", "copy7O"}), 2, "preset \"copy7O\"", "Did you mean \"copy70\"?"));
  EXPECT_TRUE(is_error(run({"presets", "copi90"}), 2, "preset \"copi90\"", "Did you mean \"copy90\"?"));
}

TEST_F(CommandLine, AnUnknownMethodEndsWithTwo) {
  const Ended ended = bake({"--method", "origami"});
  EXPECT_TRUE(is_error(ended, 2, "--method", "origami"));
  EXPECT_NE(ended.err.find("fem"), std::string::npos) << "what there is should be listed";
}

TEST_F(CommandLine, AnUnknownKeyOfSetEndsWithTwoAndTheNearestName) {
  EXPECT_TRUE(is_error(bake({"--set", "thicknes=9e-5"}), 2, "--set thicknes", "Did you mean \"thickness\"?"));
  EXPECT_TRUE(is_error(bake({"--set", "thickness=thin"}), 2, "--set thickness", "\"thin\" is not a number"));
  EXPECT_TRUE(is_error(bake({"--set", "thickness=-1"}), 2, "--set thickness", "-1"));
  EXPECT_TRUE(is_error(bake({"--set", "hardening=1"}), 2, "--set hardening", "cannot be 1"));
  EXPECT_TRUE(is_error(bake({"--set", "thickness"}), 2, "--set thickness", "value"));
}

TEST_F(CommandLine, AFrameRangeThatIsNoneEndsWithTwo) {
  for (const char* range : {"6-1", "one-six", "1-", "1-6x0", "1-6y2", "1-6 ", "1..6"}) {
    const Ended ended = run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--frames", range});
    EXPECT_TRUE(is_error(ended, 2, "--frames", range));
  }
  EXPECT_TRUE(is_error(bake({"--map-frames", "1-6,7-"}), 2, "--map-frames", "7-"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLine, ANumberThatIsNoneEndsWithTwo) {
  for (const char* option : {"--stop", "--gravity", "--fps", "--max-stretch"})
    for (const char* text : {"nan", "inf", "soon"}) EXPECT_TRUE(is_error(bake({option, text}), 2, "command line", text)) << option;
  EXPECT_TRUE(is_error(run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--frames", "1-2000000000"}), 2, "--frames", "100000"));
  EXPECT_TRUE(is_error(bake({"--preset", "missing/copy70.toml"}), 2, "missing/copy70.toml", "no such preset file"));
}

TEST_F(CommandLine, MapsAndCertificateOfAnEarlierBakeDoNotStayBesideANewOne) {
  ASSERT_EQ(bake({"--map-frames", "1-2"}).code, 0);
  const fs::path maps = fs::path(output()) / "maps", cert = fs::path(output()) / "cert";
  write(maps / "notes.txt", "mine");
  ASSERT_TRUE(fs::exists(maps / "S4_crumple.0002.exr"));
  ASSERT_EQ(bake({"--formats", "abc,maps"}).code, 0);
  EXPECT_FALSE(fs::exists(maps / "S4_crumple.0002.exr"));
  EXPECT_FALSE(fs::exists(cert / "frames.jsonl"));
  EXPECT_TRUE(fs::exists(maps / "S4_crumple.0001.exr"));
  EXPECT_TRUE(fs::exists(maps / "notes.txt"));
}

TEST_F(CommandLine, AnUnknownFormatEndsWithTwo) { EXPECT_TRUE(is_error(bake({"--formats", "abc,gif"}), 2, "--formats", "gif")); }

TEST_F(CommandLine, AFileInTheWayOfTheOutputFolderEndsWithSix) {
  fs::create_directories(folder / "out");
  write(output(), "I was here first.");
  EXPECT_TRUE(is_error(bake({}), 6, output(), "file is in the way"));
  EXPECT_EQ(read(output()), "I was here first.");
}

TEST_F(CommandLine, AFileInTheWayOfAParentFolderEndsWithSix) {
  write(folder / "out", "I was here first.");
  EXPECT_TRUE(is_error(bake({}), 6, output(), "file is in the way"));
}

TEST_F(CommandLine, DebugPicturesAreOfTheFramesOfTheMapsAndOfTheLast) {
  const std::string pictures = folder / "pictures" / "here";
  const Words words{"bake", samples + "/S4_crumple.glb", "-o", output(), "--triangles", "100", "--frames", "1-9", "--map-size", "8", "--debug-pictures"};
  const auto draw = [&](const std::string& into, const Words& more) {
    Words all = words;
    all.push_back(into);
    all.insert(all.end(), more.begin(), more.end());
    return run(all).code;
  };
  ASSERT_EQ(draw(pictures, {}), 0);
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(pictures)) found.insert(entry.path().filename());
  EXPECT_EQ(found, (std::set<std::string>{"S4_crumple.0001.png", "S4_crumple.0007.png", "S4_crumple.0009.png"}));
  const std::string bytes = read(pictures + "/S4_crumple.0007.png");
  EXPECT_EQ(bytes.substr(1, 3), "PNG");

  const std::string others = folder / "others";
  ASSERT_EQ(draw(others, {"--map-frames", "3-7x4", "--threads", "1"}), 0);
  EXPECT_FALSE(fs::exists(others + "/S4_crumple.0001.png"));
  EXPECT_TRUE(fs::exists(others + "/S4_crumple.0003.png"));
  EXPECT_EQ(read(others + "/S4_crumple.0007.png"), bytes) << "same frame, same picture";
}

TEST_F(CommandLine, AFileInTheWayOfTheDebugPicturesEndsWithSix) {
  write(folder / "pictures", "I was here first.");
  const Ended ended = bake({"--debug-pictures", folder / "pictures"});
  EXPECT_TRUE(is_error(ended, 6, folder / "pictures", "file is in the way"));
  EXPECT_NE(ended.err.find("--debug-pictures"), std::string::npos) << ended.err;
}

TEST_F(CommandLine, AFolderInTheWayOfAnOutputFileEndsWithSix) {
  fs::create_directories(fs::path(output()) / "S4_crumple.abc" / "full");
  EXPECT_TRUE(is_error(bake({}), 6, output() + "/S4_crumple.abc", ""));
}

TEST_F(CommandLine, ABusyOutputFolderEndsWithSixUntilItIsFree) {
  const fs::path state = fs::path(output()) / ".state";
  fs::create_directories(state);
  const int lock = ::open((state / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  ASSERT_GE(lock, 0);
  ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
  EXPECT_TRUE(is_error(bake({}), 6, output(), "Another bake"));
  ::close(lock);
  EXPECT_EQ(bake({}).code, 0);
}

TEST_F(CommandLine, HandlesThatAskTheImpossibleAreNamedAndEndWithFour) {
  const std::string scene = drawn_apart(1.1);
  const Ended ended = run({"bake", scene, "-o", output(), "--triangles", "50", "--map-size", "8"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_NE(ended.err.find("\"handle.still\" and \"handle.drawn\""), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("overshoot 10.00 mm (10.0 %)"), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("gate missed: "), std::string::npos) << ended.err;
  const auto summary = nlohmann::json::parse(read(fs::path(output()) / "cert" / "summary.json"));
  EXPECT_EQ(summary["exit_code"], 4);
  EXPECT_EQ(summary["impossible_handles"].size(), 1u);
  EXPECT_TRUE(fs::exists(fs::path(output()) / "drawn_apart.abc")) << "it is baked all the same";
  EXPECT_LT(double(summary["stretch_max_pct"]["max"]), 5) << "the request is projected to what paper can reach";
}

TEST_F(CommandLine, StrictRefusesTheImpossibleWithThreeBeforeAnythingIsWritten) {
  const std::string scene = drawn_apart(1.1);
  const std::string place = scene + ", handles \"handle.still\" and \"handle.drawn\"";
  EXPECT_TRUE(is_error(run({"bake", scene, "-o", output(), "--strict"}), 3, place, "overshoot 10.00 mm"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLine, HandlesThatComeCloserAskNothingImpossible) {
  const Ended ended = run({"bake", drawn_apart(0.9), "-o", output(), "--triangles", "50", "--map-size", "8", "--strict"});
  EXPECT_EQ(ended.code, 0) << ended.err;
}

TEST_F(CommandLine, ADryRunPrintsTheJobAndWritesNothing) {
  const Ended ended = bake({"--dry-run", "--seed", "7", "--set", "thickness=1e-4"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("seed = 7  # command line"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("thickness = 0.0001  # command line"), std::string::npos) << ended.out;
  EXPECT_FALSE(fs::exists(folder / "out"));
  ASSERT_EQ(bake({"--seed", "7", "--set", "thickness=1e-4"}).code, 0);
  EXPECT_EQ(read(fs::path(output()) / "job.lock.toml"), ended.out) << "it is the job that would be baked";
}

TEST_F(CommandLine, TheTracksOfAnInspectionAreWhereTheDccHasTheHandles) {
  const fs::path csv = folder / "tracks.csv";
  ASSERT_EQ(run({"inspect", samples + "/S1_push.glb", "--tracks", csv}).code, 0);
  const std::vector<std::string> tracks = lines_of(read(csv)), truth = lines_of(read(samples + "/S1_push.handles.csv"));
  EXPECT_EQ(tracks.at(0), "frame,node,x,y,z");
  std::map<std::string, std::vector<std::string>> found;  // by frame and node
  for (std::size_t i = 1; i < tracks.size(); ++i) {
    const auto row = fields_of(tracks[i]);
    EXPECT_TRUE(found.emplace(row.at(0) + " " + row.at(1), row).second) << tracks[i] << " is there twice";
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
      moved = std::max(moved, std::abs(std::stod(row.at(axis)) - std::stod(found.at("1 " + row.at(1)).at(axis))));
    }
    ++compared;
  }
  EXPECT_EQ(compared, 60 * 23);
  EXPECT_GT(moved, 0.01);
}

TEST_F(CommandLine, AnInspectionAsJsonSaysWhatIsInTheScene) {
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
    EXPECT_EQ(handle.at("mode"), handle.at("name") == "handle.mid.0" ? "relative" : "absolute") << handle;
}

TEST_F(CommandLine, TheExperimentWritesAPointForEachSheetAndAPicture) {
  const std::string csv = folder / "scatter.csv";
  const Ended ended = run({"fit", "--experiment", "copy70", "--sheets", "2", "-o", csv});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, csv + "\n" + (folder / "scatter.png").string() + "\n");
  const std::vector<std::string> lines = lines_of(read(csv));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "u,v,seed,frame");
  for (int sheet : {1, 2}) {
    const auto row = fields_of(lines[sheet]);
    EXPECT_NEAR(std::stod(row.at(0)), 0.05, 0.03);
    EXPECT_NEAR(std::stod(row.at(1)), 0.015, 0.03);
    EXPECT_EQ(row.at(2), std::to_string(sheet));
    EXPECT_GT(std::stoi(row.at(3)), 24) << "after the squeeze";
  }
  EXPECT_EQ(read(folder / "scatter.png").substr(1, 3), "PNG");
}

TEST_F(CommandLine, FittingAGradeIsNotThereYetAndEndsWithTwo) {
  EXPECT_TRUE(is_error(run({"fit", "points.csv", "--from", "copy70", "-o", folder / "my.toml"}), 2, "fit", "not in this version"));
  EXPECT_TRUE(is_error(run({"fit", "--experiment", "copi70", "-o", folder / "a.csv"}), 2, "preset \"copi70\"", "Did you mean"));
  EXPECT_TRUE(is_error(run({"fit", "--experiment", "copy70", "-o", folder / "missing" / "a.csv"}), 6, folder / "missing" / "a.csv", ""));
}

TEST_F(CommandLine, PresetsAreListedAndOnePrintedIsAPresetFile) {
  const Ended list = run({"presets"}), one = run({"presets", "copy70"});
  EXPECT_EQ(list.code, 0);
  EXPECT_TRUE(std::regex_search(list.out, std::regex("(^|\n)copy70 "))) << list.out;
  EXPECT_TRUE(std::regex_search(list.out, std::regex("(^|\n)copy90 "))) << list.out;
  ASSERT_EQ(one.code, 0) << one.err;
  std::string text = one.out;
  const std::size_t at = text.find("2.7e-4");
  ASSERT_NE(at, std::string::npos) << text;
  write(folder / "mine.toml", text.replace(at, 6, "3.1e-4"));
  const Ended job = bake({"--dry-run", "--preset", folder / "mine.toml"});
  EXPECT_EQ(job.code, 0) << job.err;
  EXPECT_NE(job.out.find("bending_stiffness = 0.00031  # preset"), std::string::npos) << job.out;
}

using Record = nlohmann::json;
std::vector<Record> frames_of(const fs::path& folder) {
  std::vector<Record> frames;
  for (const std::string& line : lines_of(read(folder / "cert" / "frames.jsonl"))) frames.push_back(Record::parse(line));
  return frames;
}

class ABake : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    ended = run(job("S4_crumple.glb", output(), "1-6"));
    ASSERT_EQ(ended.code, 0) << ended.err;
  }
  static Words job(const std::string& scene, const std::string& folder, const std::string& frames) {
    return {"bake", samples + "/" + scene, "-o", folder, "--method", "fem", "--triangles", "200", "--frames", frames, "--map-size", "64"};
  }
  std::string text(const char* file) const { return read(fs::path(output()) / file); }

  Ended ended{};
};

TEST_F(ABake, LeavesTheFilesOfTheDesignAndNoPart) {
  std::set<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(output()))
    if (entry.is_regular_file()) found.insert(fs::relative(entry.path(), output()).generic_string());
  for (const char* file : {"S4_crumple.abc", "maps/S4_crumple.0001.exr", "maps/S4_crumple.final.exr", "cert/frames.jsonl",
                           "cert/handles.csv", "cert/summary.json", "singular.csv", "job.lock.toml"})
    EXPECT_TRUE(found.count(file)) << file;
  for (const std::string& file : found) {
    EXPECT_EQ(file.find(".part"), std::string::npos) << file;
    const bool wanted_map = file == "maps/S4_crumple.0001.exr" || file == "maps/S4_crumple.final.exr";
    EXPECT_TRUE(wanted_map || file.rfind("maps/", 0) != 0) << file << " is one map too many";
  }
}

TEST_F(ABake, PrintsTheFilesOnStdoutAndTheFramesOnStderr) {
  const std::vector<std::string> files = lines_of(ended.out);
  EXPECT_FALSE(files.empty());
  for (const std::string& file : files) EXPECT_TRUE(fs::exists(file)) << file;
  EXPECT_NE(ended.err.find("frame 6"), std::string::npos) << ended.err;
}

TEST_F(ABake, HasALineAFrameWithAllKeysOfTheDesignInTheirOrder) {
  const std::vector<std::string> keys{
      "frame", "sheet", "triangles", "stretch_mean_pct", "stretch_max_pct", "angle_defect_max_deg", "handle_err_max_mm", "singular",
      "new_singular", "elastic_ms", "geometry_ms", "substeps", "newton_iterations", "converged", "energy_J", "render_triangles",
      "render_stretch_mean_pct", "render_stretch_max_pct", "render_ms", "crossings", "touching", "jammed", "note", "input_hash", "content_hash"};
  const std::vector<std::string> lines = lines_of(text("cert/frames.jsonl"));
  ASSERT_EQ(lines.size(), 6u);
  std::set<std::string> contents;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = nlohmann::ordered_json::parse(lines[i]);
    std::vector<std::string> found;
    for (const auto& [key, value] : line.items()) found.push_back(key);
    EXPECT_EQ(found, keys);
    EXPECT_EQ(line["frame"], i + 1);
    EXPECT_EQ(line["sheet"], "paper");
    EXPECT_NEAR(line["triangles"], 200, 20);
    contents.insert(line["content_hash"]);
  }
  EXPECT_EQ(contents.size(), 6u) << "the sheet moves, so no two frames are alike";
}

TEST_F(ABake, HasARowAFrameAndHandle) {
  const std::vector<std::string> rows = lines_of(text("cert/handles.csv"));
  EXPECT_EQ(rows.at(0), "frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state");
  const auto handles = nlohmann::json::parse(run({"inspect", samples + "/S4_crumple.glb", "--json"}).out)["sheets"][0]["handles"];
  EXPECT_EQ(rows.size(), 1 + 6 * handles.size());
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto row = fields_of(rows[i]);
    ASSERT_EQ(row.size(), 12u) << rows[i];
    EXPECT_TRUE(row[11] == "held" || row[11] == "free" || row[11] == "jammed") << rows[i];
    for (int axis = 0; axis < 3 && row[11] == "held"; ++axis)
      EXPECT_NEAR(std::stod(row[5 + axis]), std::stod(row[8 + axis]), 1e-9) << rows[i];
  }
}

TEST_F(ABake, SumsUpTheShotAsItsFramesSay) {
  const auto summary = nlohmann::json::parse(text("cert/summary.json"));
  EXPECT_EQ(summary.at("exit_code"), ended.code);
  EXPECT_EQ(summary.at("frames"), 6);
  EXPECT_EQ(summary.at("method"), "fem");
  for (const char* key : {"version", "settings", "machine", "models", "job_hash", "sheets"}) EXPECT_TRUE(summary.contains(key)) << key;
  for (const char* key : {"stretch_mean_pct", "stretch_max_pct", "handle_err_max_mm", "angle_defect_max_deg"}) {
    double largest = 0;
    for (const Record& frame : frames_of(output())) largest = std::max(largest, double(frame[key]));
    EXPECT_DOUBLE_EQ(summary[key].at("max"), largest) << key;
  }
  EXPECT_GT(double(summary["stretch_mean_pct"]["max"]), 0);
}

TEST_F(ABake, KeepsAListOfSingularPointsAndOfEveryValueWithItsOrigin) {
  EXPECT_EQ(lines_of(text("singular.csv")).at(0), "id,sheet,frame,u,v,cause");
  const std::string lock = text("job.lock.toml");
  for (const char* line : {"triangles = 200  # command line", "method = \"fem\"  # command line", "frames = \"1-6x1\"  # command line",
                           "seed = 0  # default"})
    EXPECT_NE(lock.find(line), std::string::npos) << line << " is not in\n" << lock;
}

TEST_F(ABake, OfEverySecondFrameHasEverySecondFrameOfTheWhole) {
  std::map<int, std::string> whole;
  for (const Record& frame : frames_of(output())) whole[frame["frame"]] = frame["content_hash"];
  const fs::path other = folder / "sparse";
  ASSERT_EQ(run(job("S4_crumple.glb", other, "2-6x2")).code, 0);
  std::vector<int> frames;
  for (const Record& frame : frames_of(other)) {
    frames.push_back(frame["frame"]);
    EXPECT_EQ(frame["content_hash"], whole[frames.back()]) << "the same frame, whichever others are written";
  }
  EXPECT_EQ(frames, (std::vector<int>{2, 4, 6}));
}

TEST_F(ABake, PutsWholeFilesOverThoseOfTheBakeBefore) {
  const std::string before = text("S4_crumple.abc");
  write(fs::path(output()) / "notes.txt", "of the artist");
  ASSERT_EQ(run(job("S4_crumple.glb", output(), "1-6")).code, 0);
  EXPECT_EQ(text("S4_crumple.abc"), before);
  EXPECT_EQ(text("notes.txt"), "of the artist");
}

TEST_F(ABake, OfAnFbxIsTheSameAsOfTheGlb) {
  const fs::path other = folder / "fbx";
  Words words = job("S4_crumple.fbx", other, "1-6");
  words.insert(words.end(), {"--start-frame", "1"});
  ASSERT_EQ(run(words).code, 0);
  const auto held = [](const std::string& csv) {
    std::map<std::string, double> z;
    for (const std::string& line : lines_of(csv))
      if (const auto row = fields_of(line); row.at(11) == "held") z[row[0] + " " + row[2]] = std::stod(row[10]);
    return z;
  };
  const auto glb = held(text("cert/handles.csv")), fbx = held(read(other / "cert" / "handles.csv"));
  ASSERT_EQ(glb.size(), fbx.size());
  ASSERT_GT(glb.size(), 20u);
  for (const auto& [key, z] : glb) EXPECT_NEAR(fbx.at(key), z, 2e-4) << key;  // the FBX keeps its keys a little coarser
}

}  // namespace
}  // namespace paperbake
