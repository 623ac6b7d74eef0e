// Bakes that are asked to end, or that cannot say anything.

#include "tests/baker/bake/resume_fixture.h"

#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::Ended;
using test::is_error;
using test::read;
using test::samples;
using test::Words;
using test::write;

class StopTest : public test::ResumeFixture {
 protected:
  /// A bake whose frames take a quarter of a second to render.
  Words hero(const std::string& out) const {
    return words(out, {"--quality", "hero", "--polish", "0", "--formats", "abc,usd,cert"}, "1-16");
  }
  static Words as_told(Words all, const std::string& progress) {
    *std::next(std::find(all.begin(), all.end(), "--progress")) = progress;
    return all;
  }
  void whole_hero(const std::string& out) const {
    const Ended ended = run(hero(out));
    ASSERT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  }
  /// What the program does with its standard error leading to there.
  int run_with_stderr(const char* where, const Words& all) const {
    std::string line = PAPERBAKE_PROGRAM;
    for (const std::string& word : all) line += " '" + word + "'";
    const int status =
        std::system(("exec " + line + " > " + (folder / "listed").string() + " " + where).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
};

TEST_F(StopTest, ABakeThatIsStoppedWhileItRendersEndsWithinASecondAndGoesOnThere) {
  whole_hero("whole");
  const pid_t child = test::start(folder, hero("out"));
  while (times(read(folder / "stderr.txt"), "rendered frame") < 3) usleep(2000);
  const auto signalled = std::chrono::steady_clock::now();
  kill(child, SIGTERM);
  EXPECT_EQ(test::exit_code(child), 5);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - signalled).count();
  EXPECT_LT(seconds, 1.2) << "a second, and something for a busy machine";
  const int rendered = times(read(folder / "stderr.txt"), "rendered frame");
  ASSERT_LT(rendered, 16);

  const Ended rest = run(hero("out"));
  EXPECT_EQ(simulated(rest), 0) << rest.err;
  EXPECT_NE(rest.err.find("frames are as an earlier bake rendered them"), std::string::npos);
  expect_same("out", "whole");
  for (const auto& entry : fs::directory_iterator(folder / "out/.state"))
    EXPECT_NE(entry.path().stem(), "rendered") << "a complete bake needs it no more";
}

TEST_F(StopTest, ASecondSignalEndsItAtOnceAndLosesNothing) {
  whole_hero("whole");
  const pid_t child = test::start(folder, hero("out"));
  while (times(read(folder / "stderr.txt"), "rendered frame") < 4) usleep(2000);
  kill(child, SIGINT);
  usleep(20000);
  const auto again = std::chrono::steady_clock::now();
  kill(child, SIGINT);
  EXPECT_EQ(test::exit_code(child), 5);
  EXPECT_LT(std::chrono::steady_clock::now() - again, std::chrono::milliseconds(300));
  for (const auto& entry : fs::recursive_directory_iterator(folder / "out"))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  const int told = times(read(folder / "stderr.txt"), "rendered frame");
  const Ended rest = run(hero("out"));
  EXPECT_EQ(simulated(rest), 0) << rest.err;
  const std::size_t sentence = rest.err.find(" frames are as an earlier bake rendered them");
  ASSERT_NE(sentence, std::string::npos) << rest.err;
  EXPECT_GE(std::stoi(rest.err.substr(rest.err.rfind('\n', sentence) + 1)), told)
      << "a frame that was told of is not rendered again";
  expect_same("out", "whole");
}

TEST_F(StopTest, ASignalWhileAFrameIsSimulatedForLongIsObeyed) {
  // its frames take seconds
  const pid_t child =
      test::start(folder, {"bake", samples + "/S4_crumple.glb", "-o", output(), "--method", "fem",
                           "--triangles", "30000", "--frames", "1-40", "--progress", "plain"});
  usleep(1500000);
  const auto signalled = std::chrono::steady_clock::now();
  kill(child, SIGTERM);
  EXPECT_EQ(test::exit_code(child), 5);
  EXPECT_LT(std::chrono::steady_clock::now() - signalled, std::chrono::milliseconds(1200));
  EXPECT_NE(read(folder / "stderr.txt").find("stopped"), std::string::npos);
}

TEST_F(StopTest, ABakeThatIsEndedInTheMiddleOfAFrameTellsItsEnd) {
  const std::string log = folder / "bake.log";
  const pid_t child = test::start(
      folder, {"bake", samples + "/S4_crumple.glb", "-o", output(), "--method", "fem",
               "--triangles", "30000", "--frames", "1-40", "--progress", "json", "--log", log});
  while (read(folder / "stderr.txt").find("\"start\"") == std::string::npos) usleep(2000);
  for (int signals = 0; signals < 2; ++signals) {
    kill(child, SIGTERM);
    usleep(20000);
  }
  EXPECT_EQ(test::exit_code(child), 5);
  std::string last;
  for (const std::string& line : test::lines_of(read(folder / "stderr.txt")))
    if (line.rfind("{", 0) == 0) last = line;
  const auto end = nlohmann::json::parse(last);
  EXPECT_EQ(end.at("type"), "end");
  EXPECT_EQ(end.at("result"), "stopped");
  EXPECT_EQ(times(read(folder / "stderr.txt"), "\"end\""), 1);
  EXPECT_NE(read(log).find("stopped after"), std::string::npos) << read(log);
}

TEST_F(StopTest, AStandardErrorThatCannotBeWrittenChangesNothing) {
  bake_whole("whole", {}, "1-6");
  int n = 0;
  for (const char* where : {"2>&-", "2>/dev/full", "2>&- <&- >&-"})
    for (const char* progress : {"plain", "json"}) {
      const std::string out = fmt::format("out{}", n++);
      EXPECT_EQ(run_with_stderr(where, as_told(words(out, {}, "1-6"), progress)), 0)
          << where << " " << progress;
      expect_same(out, "whole");
    }
  EXPECT_EQ(run_with_stderr("2>/dev/full", {"bake", "no.glb", "-o", "out"}), 3);
}

TEST_F(StopTest, DataThatCannotBeWrittenIsAnError) {
  const auto to = [&](const char* where, const Words& all) {
    std::string line = PAPERBAKE_PROGRAM;
    for (const std::string& word : all) line += " '" + word + "'";
    const int status = std::system(("exec " + line + " 2> /dev/null " + where).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  const std::string scene = samples + "/S1_push.glb";
  for (const Words& data :
       {Words{"presets", "copy70"}, Words{"inspect", scene},
        Words{"inspect", scene, "--tracks", "-"}, Words{"bake", scene, "--dry-run"}}) {
    EXPECT_EQ(to("> /dev/null", data), 0) << data[0];
    EXPECT_EQ(to("> /dev/full", data), 6) << data[0];
  }
}

TEST_F(StopTest, WhatIsNoFileIsRefusedAndNotWaitedFor) {
  const std::string fifo = folder / "fifo.toml", scene = folder / "fifo.glb";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0666), 0);
  ASSERT_EQ(mkfifo(scene.c_str(), 0666), 0);
  EXPECT_TRUE(is_error(run({"bake", fifo, "-o", output()}), 2, fifo, "this is a FIFO"));
  EXPECT_TRUE(is_error(run({"bake", scene, "-o", output()}), 3, scene, "a FIFO"));
  EXPECT_TRUE(is_error(bake({"--preset", fifo}), 2, fifo, "this is a FIFO"));
  fs::rename(scene, folder / "fifo.abc");
  EXPECT_TRUE(is_error(run({"inspect", folder / "fifo.abc"}), 3, folder / "fifo.abc", "a FIFO"));
  fs::create_symlink("/dev/zero", folder / "zero.toml");
  EXPECT_TRUE(is_error(run({"bake", folder / "zero.toml", "-o", output()}), 2, folder / "zero.toml",
                       "this is a device"));
}

TEST_F(StopTest, PlantedLinksAreNotFollowed) {
  write(folder / "precious", "mine");
  fs::create_directories(folder / "out");
  fs::create_symlink(folder / "precious", folder / "out/S4_crumple.abc.part");
  fs::create_symlink(folder / "precious", folder / "out/S4_crumple.abc");
  fs::create_symlink(folder / "precious", folder / "out/report.html.part");
  bake_whole("out", {}, "1-3");
  EXPECT_EQ(read(folder / "precious"), "mine");
  EXPECT_FALSE(fs::is_symlink(folder / "out/S4_crumple.abc"));
  fs::create_directories(folder / "linked");
  fs::create_directories(folder / "elsewhere");
  fs::create_symlink(folder / "elsewhere", folder / "linked/maps");
  EXPECT_TRUE(is_error(run(as_told(words("linked", {}, "1-3"), "none")), 6, folder / "linked/maps",
                       "link"));
  EXPECT_TRUE(fs::is_empty(folder / "elsewhere"));
}

}  // namespace
}  // namespace paperbake
