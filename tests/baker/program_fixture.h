#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <spawn.h>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

extern char** environ;

/// The built program, run with words in a folder of the test's own, and the files and words it
/// leaves there.
namespace paperbake::test {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

inline const std::string samples = PAPERBAKE_SAMPLES;

inline std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.is_open()) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

struct Ended {
  int code;  // -1: it did not exit by itself
  std::string out, err;
};

/// Starts paperbake as a shell would; what it says goes to stdout.txt and stderr.txt in the test's
/// own folder. -1: it cannot be started
inline pid_t start(const fs::path& folder, const Words& words) {
  const std::string out = folder / "stdout.txt", err = folder / "stderr.txt";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0666);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0666);
  std::vector<char*> arguments{const_cast<char*>(PAPERBAKE_PROGRAM)};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed =
      posix_spawn(&child, PAPERBAKE_PROGRAM, &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(failed, 0) << PAPERBAKE_PROGRAM << " cannot be started";
  return failed ? -1 : child;
}

/// Waits for its end. returns  its exit code; -1: it did not exit by itself
inline int exit_code(pid_t child) {
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status)
                                                                               : -1;
}

inline Ended paperbake(const fs::path& folder, const Words& words) {
  const int code = exit_code(start(folder, words));
  return {code, read(folder / "stdout.txt"), read(folder / "stderr.txt")};
}

/// paperbake: PLACE, then at least one indented line and nothing else; nothing on stdout.
inline testing::AssertionResult is_error(const Ended& ended, int code, const std::string& place,
                                         const std::string& cause) {
  const auto fails = [&](const std::string& why) {
    return testing::AssertionFailure() << why << "\nexit code " << ended.code
                                       << "\nstdout: " << ended.out << "\nstderr: " << ended.err;
  };
  const std::vector<std::string> lines = lines_of(ended.err);
  if (ended.code != code) return fails(fmt::format("exit code {} expected", code));
  if (!ended.out.empty()) return fails("an error belongs on stderr alone");
  if (lines.size() < 2 || lines.size() > 3)
    return fails("two or three lines expected: place, cause, remedy");
  if (lines[0].rfind("paperbake: " + place, 0) != 0)
    return fails("the first line should begin with: paperbake: " + place);
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (lines[i].rfind("  ", 0) != 0 || lines[i].size() < 4)
      return fails("not an indented line: " + lines[i]);
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
    Words words{"bake",     scene, "-o",         output(), "--triangles", "100",
                "--frames", "1-2", "--map-size", "8",      "--progress",  "none"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }

  /// The first frames of a crumple, elastic, of 200 triangles.
  Words crumple(const std::string& frames, const Words& more) const {
    Words words{"bake",        samples + "/S4_crumple.glb",
                "-o",          output(),
                "--method",    "fem",
                "--triangles", "200",
                "--frames",    frames,
                "--map-size",  "32"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  std::string output() const { return folder / "out" / "shot"; }

  fs::path folder;
};

}  // namespace paperbake::test
