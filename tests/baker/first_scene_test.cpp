// The scene that samples/run bakes when none is named: what a newcomer sees first.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::Ended;
using test::read;

class FirstScene : public test::CommandLine {};

TEST_F(FirstScene, TheFirstSceneCrumplesAndMissesNoGateWhateverTheSeed) {
  for (int seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Ended ended =
        run({"bake", test::samples + "/S0_note.glb", "-o", output(), "--seed", std::to_string(seed),
             "--quality", "draft", "--formats", "abc,cert", "--progress", "plain"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(ended.err.find("warning"), std::string::npos) << ended.err;
    int jammed = 0, singular = 0;
    for (const std::string& line :
         test::lines_of(read(fs::path(output()) / "cert" / "frames.jsonl"))) {
      const auto frame = nlohmann::json::parse(line);
      jammed += static_cast<int>(frame["jammed"].size());
      singular = frame["singular"];
    }
    EXPECT_EQ(jammed, 0);
    EXPECT_GE(singular, 12);  // 18 to 34 for seeds 0 to 31
  }
}

}  // namespace
}  // namespace paperbake
