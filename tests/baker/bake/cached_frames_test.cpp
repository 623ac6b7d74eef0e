// Caches of a bake that is stopped more than once.

#include "baker/bake/bake.h"
#include "core/model/error.h"
#include "formats/cache/alembic_reader.h"
#include "tests/baker/program_fixture.h"

#include <atomic>
#include <chrono>
#include <map>
#include <thread>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::read;

class CachedFramesTest : public test::CommandLine {
 protected:
  BakeSettings settings(const std::string& out) const {
    BakeSettings settings;
    settings.scene = test::samples + "/S4_crumple.glb";
    settings.output = folder / out;
    settings.method = "fem";
    settings.triangles = 200;
    settings.frames = FrameSpan{1, 16, 1};
    settings.quality = Quality::draft;
    settings.formats = {"abc", "cert", "maps"};
    settings.map_size = 32;
    settings.threads = 1;  // else it may be simulated to its end before frames are counted
    settings.map_frames = std::vector<FrameSpan>{{1, 16, 4}};
    return settings;
  }

  /// A bake that is asked to end when it has simulated so many frames, or told something.
  /// each     frame that it renders takes so long
  /// returns  what it says of its end; empty: it was not stopped
  static std::string bake_until(int frames, std::chrono::milliseconds each,
                                const BakeSettings& settings,
                                const std::string& words = "nothing") {
    std::atomic<int> simulated = 0;
    std::atomic<bool> told = false;
    const auto count = [&](const ProgressStep& step) {
      if (step.pass == "simulated")
        simulated = step.done;
      else
        std::this_thread::sleep_for(each);
    };
    const auto listen = [&](const std::string& sentence) {
      told = told || sentence.find(words) != std::string::npos;
    };
    Progress progress(count, listen, 16, passes_of(settings));
    try {
      paperbake::bake(settings, plan_bake(settings), progress,
                      [&] { return told || simulated >= frames; });
      return {};
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::stopped) << error.what();
      return error.what();
    }
  }

  int cached(const std::string& out, const std::string& shot = "S4_crumple") const {
    const AlembicReader cache(folder / out / (shot + ".abc"));
    return static_cast<int>(cache.sheets().at(0).frames);
  }

  std::map<std::string, std::string> files(const std::string& out) const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder / out)) {
      const std::string name = fs::relative(entry.path(), folder / out).generic_string();
      if (entry.is_regular_file() && name.rfind(".state", 0) != 0) found[name] = read(entry.path());
    }
    return found;
  }
};

constexpr std::chrono::milliseconds no_time{0}, too_long{600};  // half a second is left to a stop
constexpr int never = 1000;                                     // frames

TEST_F(CachedFramesTest, AStopDoesNotReplaceCachesOfTheSameBakeByShorterOnes) {
  const BakeSettings both = settings("out");
  ASSERT_NE(bake_until(8, no_time, both), "");
  const int first = cached("out");
  ASSERT_GT(first, 1);
  const auto before = files("out");
  ASSERT_TRUE(before.count("maps/S4_crumple.final.exr"));

  const std::string told = bake_until(14, too_long, both);
  EXPECT_NE(told.find("its caches have more frames"), std::string::npos) << told;
  EXPECT_EQ(cached("out"), first);
  const auto after = files("out");
  for (const auto& [name, bytes] : before)
    EXPECT_TRUE(after.count(name) && after.at(name) == bytes) << name;
  // a later bake that writes fewer maps knows whose they are
  EXPECT_TRUE(after.count("maps/S4_crumple.0013.exr"));
  EXPECT_NE(read(folder / "out/.state/written").find("maps/S4_crumple.0013.exr"),
            std::string::npos);

  EXPECT_EQ(bake_until(never, no_time, both), "");
  EXPECT_EQ(bake_until(never, no_time, settings("whole")), "");
  const auto got = files("out"), wanted = files("whole");
  EXPECT_EQ(got.size(), wanted.size());
  for (const char* name : {"S4_crumple.abc", "maps/S4_crumple.final.exr"})
    EXPECT_TRUE(got.at(name) == wanted.at(name)) << name;
}

TEST_F(CachedFramesTest, AStopReplacesShorterCachesAndThoseOfAnotherBake) {
  ASSERT_NE(bake_until(4, too_long, settings("out")), "");
  const int first = cached("out");
  ASSERT_NE(bake_until(8, no_time, settings("out")), "");
  EXPECT_GT(cached("out"), first);

  BakeSettings other = settings("out");
  other.triangles = 220;
  ASSERT_NE(bake_until(4, too_long, other), "");
  EXPECT_EQ(cached("out"), first) << "longer ones are of another mesh";
}

TEST_F(CachedFramesTest, AStopReplacesCachesOfAnAttemptThatIsNotBaked) {
  BakeSettings smooth = settings("out");
  smooth.scene = test::samples + "/S7_stacks.glb";
  smooth.method = "hybrid";
  smooth.triangles.reset();
  smooth.frames.reset();
  smooth.formats = {"abc", "cert"};
  ASSERT_NE(bake_until(never, no_time, smooth, "is tried"), "");
  const int of_first = cached("out", "S7_stacks");
  ASSERT_GT(of_first, 1);
  ASSERT_NE(bake_until(never, too_long, smooth, "one of 480 is baked"), "");
  EXPECT_LT(cached("out", "S7_stacks"), of_first);
}

}  // namespace
}  // namespace paperbake
