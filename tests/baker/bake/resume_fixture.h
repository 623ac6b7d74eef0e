#pragma once

#include "tests/baker/program_fixture.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <map>

namespace paperbake::test {

/// The files of a bake that are the same whenever it is baked, and the certificate without its
/// times.
inline std::map<std::string, std::string> comparable_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).generic_string();
    if (!entry.is_regular_file() || name.rfind(".state", 0) == 0) continue;
    const std::string kind = entry.path().extension();
    if (kind == ".abc" || kind == ".exr" || kind == ".csv" || kind == ".usda")
      files[name] = read(entry.path());
    if (name != "cert/frames.jsonl") continue;
    for (const std::string& line : lines_of(read(entry.path()))) {
      auto record = nlohmann::json::parse(line);
      for (const char* time : {"elastic_ms", "geometry_ms", "render_ms"}) record.erase(time);
      files[name] += record.dump() + "\n";
    }
  }
  return files;
}

class ResumeFixture : public CommandLine {
 protected:
  /// Where a crumple touches itself and gets singular points; method and speed of a few frames a
  /// second.
  Words words(const std::string& out, const Words& more, const std::string& frames = "1-60") const {
    Words all{"bake",         samples + "/S4_crumple.glb",
              "-o",           (folder / out).string(),
              "--frames",     frames,
              "--map-size",   "32",
              "--map-frames", "1-96x6",
              "--progress",   "plain"};
    if (std::find(more.begin(), more.end(), "--quality") == more.end())
      all.insert(all.end(), {"--quality", "draft"});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// Starts a bake, and when it has told of this many frames it gets the signal, so many
  /// microseconds later. returns its exit code; -1: it was killed
  int bake_until(int frames, int later, int signal, const Words& all,
                 const std::string& told = "simulated frame") const {
    const pid_t child = start(folder, all);
    siginfo_t ended{};
    while (waitid(P_PID, child, &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0) {
      if (times(read(folder / "stderr.txt"), told) >= frames) {
        usleep(later);
        kill(child, signal);
        break;
      }
      usleep(2000);
    }
    return exit_code(child);
  }

  std::set<std::string> checkpoints(const std::string& out) const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder / out / ".state"))
      if (entry.path().filename().string().rfind("checkpoint", 0) == 0)
        found.insert(entry.path().filename());
    return found;
  }

  static int times(const std::string& text, const std::string& words) {
    int count = 0;
    for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; at += words.size())
      ++count;
    return count;
  }
  static int simulated(const Ended& ended) { return times(ended.err, "simulated frame"); }

  /// A bake that is never disturbed.
  void bake_whole(const std::string& out, const Words& more,
                  const std::string& frames = "1-60") const {
    const Ended ended = run(words(out, more, frames));
    ASSERT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  }

  void expect_same(const std::string& out, const std::string& whole) const {
    const auto got = comparable_files(folder / out), wanted = comparable_files(folder / whole);
    ASSERT_GT(wanted.size(), 3u);
    for (const auto& [name, bytes] : wanted)
      EXPECT_TRUE(got.count(name) && got.at(name) == bytes)
          << name << " is not as a bake at one go writes it";
    EXPECT_EQ(got.size(), wanted.size());
    for (const auto& entry : fs::recursive_directory_iterator(folder / out))
      EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
};

class ResumePushFixture : public ResumeFixture {
 protected:
  /// Sheets held at two corners and pushed at the border between the others, for 30 frames. lift
  /// [m] of the last key, at frame 30
  enum Arrangement { beside, over };
  Words pushed(const std::string& out, int sheets, double lift, Arrangement where = beside) const {
    test::GltfFixture scene;
    for (int s = 0; s < sheets; ++s) {
      const Vector3d place(where == beside ? 0.2 * s : 0, 0, where == over ? 0.004 * s : 0),
          at = place + Vector3d(0.1, 0.05, 0);
      scene.mesh(fmt::format("paper_{}", s),
                 test::grid(4, 4, 0.1, 0.1, nullptr, [&](double u, double v) {
                   return Vector3d(place + Vector3d(u, v, 0));
                 }));
      scene.node(fmt::format("handle_{}a", s), place);
      scene.node(fmt::format("handle_{}b", s), place + Vector3d(0, 0.1, 0));
      scene.move(scene.node(fmt::format("handle_{}c", s), at), {1, 10, 20, 30},
                 {at, at + Vector3d(-0.01, 0, 0.01), at + Vector3d(-0.02, 0, 0.01),
                  at + Vector3d(-0.02, 0, s == 0 || where == beside ? lift : -lift)});
    }
    return {"bake",         scene.write("pushed.gltf"),
            "-o",           folder / out,
            "--map-size",   "32",
            "--quality",    "draft",
            "--progress",   "plain",
            "--checkpoint", "6"};
  }
};

}  // namespace paperbake::test
