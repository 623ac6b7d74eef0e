// What a second bake in the same folder does: nothing, or what is left to do, and with the bytes that one bake alone would have written.

#include "tests/gltf_fixture.h"
#include "tests/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::CommandLine;
using test::Ended;
using test::is_error;
using test::lines_of;
using test::read;
using test::samples;
using test::Words;
using test::write;

/// The files of a bake that are the same whenever it is baked, and the certificate without its times.
std::map<std::string, std::string> lasting(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).generic_string();
    if (!entry.is_regular_file() || name.rfind(".state", 0) == 0) continue;
    const std::string kind = entry.path().extension();
    if (kind == ".abc" || kind == ".exr" || kind == ".csv" || kind == ".usda") files[name] = read(entry.path());
    if (name != "cert/frames.jsonl") continue;
    for (const std::string& line : lines_of(read(entry.path()))) {
      auto record = nlohmann::json::parse(line);
      for (const char* time : {"elastic_ms", "geometry_ms", "render_ms"}) record.erase(time);
      files[name] += record.dump() + "\n";
    }
  }
  return files;
}

class AResumedBake : public CommandLine {
 protected:
  /// Where a crumple touches itself and gets singular points; method and speed of a few frames a second.
  Words words(const std::string& out, const Words& more, const std::string& frames = "1-60") const {
    Words all{"bake", samples + "/S4_crumple.glb", "-o", (folder / out).string(), "--frames", frames, "--map-size", "32", "--map-frames", "1-96x6", "--quality", "draft", "--progress", "plain"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// Starts a bake, and when it has told of this many frames it gets the signal. returns its exit code; -1: it was killed
  int bake_until(int frames, int signal, const Words& all) const {
    const fs::path err = folder / "killed.txt";
    write(err, "");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_TRUNC, 0666);
    std::vector<char*> arguments{const_cast<char*>(PAPERBAKE_PROGRAM)};
    for (const std::string& word : all) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_t child = 0;
    EXPECT_EQ(posix_spawn(&child, PAPERBAKE_PROGRAM, &actions, nullptr, arguments.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
      const std::string told = read(err);
      if (std::count(told.begin(), told.end(), '\n') >= frames) {
        kill(child, signal);
        waitpid(child, &status, 0);
        break;
      }
      usleep(2000);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::set<std::string> checkpoints(const std::string& out) const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder / out / ".state"))
      if (entry.path().filename().string().rfind("checkpoint", 0) == 0) found.insert(entry.path().filename());
    return found;
  }

  static int simulated(const Ended& ended) {
    int count = 0;
    for (const std::string& line : lines_of(ended.err)) count += line.find("simulated frame") != std::string::npos;
    return count;
  }

  /// A bake that is never disturbed.
  void bake_whole(const std::string& out, const Words& more, const std::string& frames = "1-60") const {
    const Ended ended = run(words(out, more, frames));
    ASSERT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  }

  void expect_same(const std::string& out, const std::string& whole) const {
    const auto got = lasting(folder / out), wanted = lasting(folder / whole);
    ASSERT_GT(wanted.size(), 3u);
    for (const auto& [name, bytes] : wanted) EXPECT_TRUE(got.count(name) && got.at(name) == bytes) << name << " is not as a bake at one go writes it";
    EXPECT_EQ(got.size(), wanted.size());
    for (const auto& entry : fs::recursive_directory_iterator(folder / out)) EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
};

TEST_F(AResumedBake, DoesNothingWhenNothingHasChanged) {
  const Ended first = run(words("out", {}, "1-6"));
  ASSERT_EQ(simulated(first), 6) << first.err;
  const auto before = fs::last_write_time(folder / "out/S4_crumple.abc");
  const Ended second = run(words("out", {"--threads", "1", "--checkpoint", "3"}, "1-6"));
  EXPECT_EQ(second.code, first.code);
  EXPECT_EQ(second.out, first.out);
  EXPECT_EQ(second.err.find("frame"), std::string::npos) << second.err;
  EXPECT_EQ(fs::last_write_time(folder / "out/S4_crumple.abc"), before);
}

TEST_F(AResumedBake, ThatMissedAGateMissesItAgainWithoutWork) {
  const Ended first = run(words("out", {"--max-stretch", "1e-7"}, "1-6"));
  ASSERT_EQ(first.code, 4) << first.err;
  const Ended second = run(words("out", {"--max-stretch", "1e-7"}, "1-6"));
  EXPECT_EQ(second.code, 4);
  EXPECT_EQ(simulated(second), 0);
  EXPECT_NE(second.err.find("gate missed: Frame"), std::string::npos) << second.err;
}

TEST_F(AResumedBake, WritesAgainWhatSomebodyChangedOrTookAwayAndWhatIsAskedForBesides) {
  bake_whole("out", {}, "1-6");
  bake_whole("whole", {"--formats", "abc,maps,cert,report,usd"}, "1-6");
  write(folder / "out/singular.csv", "mine");
  Ended again = run(words("out", {}, "1-6"));
  EXPECT_EQ(simulated(again), 0) << again.err;
  EXPECT_NE(again.err.find("rendered frame 6"), std::string::npos) << again.err;
  EXPECT_NE(read(folder / "out/singular.csv"), "mine");
  fs::remove(folder / "out/maps/S4_crumple.final.exr");
  again = run(words("out", {"--formats", "abc,maps,cert,report,usd"}, "1-6"));
  EXPECT_EQ(simulated(again), 0) << again.err;
  expect_same("out", "whole");
}

TEST_F(AResumedBake, OfMoreFramesSimulatesTheNewOnes) {
  bake_whole("out", {}, "1-20");
  bake_whole("whole", {}, "1-30");
  const Ended longer = run(words("out", {}, "1-30"));
  EXPECT_EQ(simulated(longer), 10) << longer.err;
  expect_same("out", "whole");
  const Ended shorter = run(words("out", {"--quality", "shot"}, "7-17x2"));
  EXPECT_EQ(simulated(shorter), 0) << shorter.err;
  bake_whole("shorter", {"--quality", "shot"}, "7-17x2");
  expect_same("out", "shorter");
}

class AKilledBake : public AResumedBake, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, AKilledBake, testing::Values("hybrid", "fem", "adaptive"), [](const auto& info) { return std::string(info.param); });

TEST_P(AKilledBake, GoesOnFromItsLastCheckpointToTheSameBytes) {
  const bool hybrid = std::string(GetParam()) == "hybrid";
  const std::string frames = hybrid ? "1-72" : "1-20";
  Words how{"--method", GetParam(), "--checkpoint", hybrid ? "12" : "4"};
  if (!hybrid) how.insert(how.end(), {"--triangles", "300"});
  bake_whole("whole", how, frames);
  const int kills[] = {hybrid ? 14 : 5, hybrid ? 20 : 3, hybrid ? 9 : 4};
  for (const int kill : kills) EXPECT_EQ(bake_until(kill, SIGKILL, words("out", how, frames)), -1);
  const Ended last = run(words("out", how, frames));
  EXPECT_GT(simulated(last), 0);
  EXPECT_LT(simulated(last), hybrid ? 60 : 16) << last.err;
  expect_same("out", "whole");
  if (hybrid) {
    int births = 0, touching = 0;
    for (const std::string& line : lines_of(read(folder / "out/cert/frames.jsonl"))) {
      const auto record = nlohmann::json::parse(line);
      births += record["new_singular"].get<int>(), touching += record["touching"] > 0;
    }
    EXPECT_GT(births, 0) << "a crumple without a birth proves little";
    EXPECT_GT(touching, 0);
  }
}

TEST_F(AResumedBake, ThatIsStoppedKeepsWhatItHasAndGoesOn) {
  bake_whole("whole", {}, "1-40");
  EXPECT_EQ(bake_until(7, SIGTERM, words("out", {}, "1-40")), 5);
  EXPECT_NE(read(folder / "killed.txt").find("The bake was stopped."), std::string::npos);
  const auto summary = nlohmann::json::parse(read(folder / "out/cert/summary.json"));
  EXPECT_EQ(summary["exit_code"], 5);
  const int frames = summary["frames"];
  EXPECT_LT(frames, 40);
  EXPECT_EQ(run({"verify", folder / "out"}).code, 0);
  EXPECT_EQ(bake_until(4, SIGINT, words("out", {}, "1-40")), 5);
  const Ended rest = run(words("out", {}, "1-40"));
  EXPECT_LT(simulated(rest), 40 - frames) << "nothing is simulated twice";
  expect_same("out", "whole");
}

TEST_F(AResumedBake, NeverSimulatesEveryFrame) {
  bake_whole("out", {}, "1-6");
  EXPECT_EQ(simulated(run(words("out", {"--resume", "never"}, "1-6"))), 6);
  EXPECT_TRUE(is_error(run(words("out", {"--resume", "always"}, "1-6")), 2, "--resume", "always"));
}

TEST_F(AResumedBake, OfOtherPaperOrSeedBeginsAnew) {
  bake_whole("out", {}, "1-6");
  EXPECT_EQ(simulated(run(words("out", {"--seed", "3"}, "1-6"))), 6);
  EXPECT_EQ(simulated(run(words("out", {"--seed", "3", "--set", "thickness=1e-4"}, "1-6"))), 6);
  bake_whole("whole", {"--seed", "3", "--set", "thickness=1e-4"}, "1-6");
  expect_same("out", "whole");
}

TEST_F(AResumedBake, FromADamagedCheckpointTakesTheOneBeforeItAndSaysSo) {
  const Words every{"--checkpoint", "4"};
  bake_whole("whole", every, "1-14");
  int damage = 0;
  for (const auto& spoil : std::vector<std::function<void(std::string&)>>{[](std::string& s) { s[s.size() / 2] ^= 4; }, [](std::string& s) { s.resize(s.size() / 3); },
                                                                           [](std::string& s) { s.clear(); }, [](std::string& s) { s += "more"; }}) {
    const std::string out = fmt::format("out{}", damage++);
    fs::copy(folder / "whole", folder / out, fs::copy_options::recursive);
    ASSERT_EQ(checkpoints(out), (std::set<std::string>{"checkpoint.0.000004", "checkpoint.0.000008", "checkpoint.0.000012", "checkpoint.0.000014"}));
    std::string bytes = read(folder / out / ".state/checkpoint.0.000012");
    spoil(bytes);
    write(folder / out / ".state/checkpoint.0.000012", bytes);
    fs::remove(folder / out / "report.html");
    const Ended again = run(words(out, every, "1-14"));
    EXPECT_NE(again.err.find("checkpoint.0.000012 is damaged: the frames after 8 are simulated again."), std::string::npos) << again.err;
    EXPECT_EQ(simulated(again), 6);
    expect_same(out, "whole");
  }
}

TEST_F(AResumedBake, WithAKeyMovedGoesOnFromTheCheckpointBeforeIt) {
  const auto bake_with = [&](const std::string& out, double lift) {
    test::GltfFixture scene;
    scene.mesh("paper", test::grid(4, 4, 0.1, 0.1));
    scene.node("handle_a", {0, 0, 0});
    scene.node("handle_b", {0, 0.1, 0});
    const Vector3d at(0.1, 0.05, 0);
    scene.move(scene.node("handle_c", at), {1, 10, 20, 30}, {at, at + Vector3d(-0.01, 0, 0.01), at + Vector3d(-0.02, 0, 0.01), at + Vector3d(-0.02, 0, lift)});
    return run({"bake", scene.write("key_moved.gltf"), "-o", folder / out, "--map-size", "32", "--quality", "draft", "--progress", "plain", "--checkpoint", "6"});
  };
  const Ended first = bake_with("out", 0.03);
  ASSERT_TRUE(first.code == 0 || first.code == 4) << first.err;
  ASSERT_EQ(simulated(first), 30);
  const Ended moved = bake_with("out", 0.02);
  EXPECT_EQ(simulated(moved), 12) << moved.err;
  bake_with("whole", 0.02);
  expect_same("out", "whole");
}

TEST_F(AResumedBake, ThatCannotKeepACheckpointGoesOnAndSaysSo) {
  fs::create_directories(folder / "out/.state/checkpoint.0.000006/in_the_way");
  const Ended ended = run(words("out", {}, "1-6"));
  EXPECT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  EXPECT_NE(ended.err.find("warning: what a later bake would go on from could not be kept"), std::string::npos) << ended.err;
  bake_whole("whole", {}, "1-6");
  fs::remove_all(folder / "out/.state/checkpoint.0.000006");
  expect_same("out", "whole");
}

}  // namespace
}  // namespace paperbake
