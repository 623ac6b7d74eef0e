// What a bake tells of how far it is, on stderr.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <regex>
#include <string>

namespace paperbake {
namespace {

using ProgressTest = test::CommandLine;
using test::Ended;
using test::lines_of;
using test::Words;

TEST_F(ProgressTest, BothPassesOfABakeTellOfEveryFrame) {
  const Ended ended = run(crumple("1-3", {"--fps", "24", "--progress", "json"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  std::map<std::string, int> done;
  for (const std::string& line : lines_of(ended.err)) {
    const auto given = nlohmann::json::parse(line);
    if (given["type"] != "frame") continue;
    EXPECT_EQ(given["done"], ++done[given["pass"]]) << line;
    EXPECT_EQ(given["frame"], given["done"]);
    EXPECT_EQ(given["frames"], 3);
    EXPECT_GE(double(given["seconds_left"]), 0);
    if (given["pass"] == "rendered") {
      EXPECT_GT(given["triangles"], 10000);
    }
  }
  EXPECT_EQ(done, (std::map<std::string, int>{{"rendered", 3}, {"simulated", 3}}));
}

TEST_F(ProgressTest, TheTotalOfAPassIsWhatItDoes) {
  const Ended ended =
      run(crumple("1-40", {"--fps", "24", "--formats", "preview", "--progress", "json"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  std::map<std::string, int> done, frames;
  for (const std::string& line : lines_of(ended.err)) {
    const auto given = nlohmann::json::parse(line);
    if (given["type"] != "frame") continue;
    ++done[given["pass"]];
    frames[given["pass"]] = given["frames"];
  }
  EXPECT_EQ(done["simulated"], 40);
  EXPECT_LT(done["rendered"], 17) << "a preview shows at most 16 frames";
  EXPECT_EQ(frames, done);
}

TEST_F(ProgressTest, APlainBakeSaysWhichPassIsAtWhichFrame) {
  const Ended ended = run(crumple("1-2", {"--fps", "24", "--progress", "plain"}));
  for (const char* words : {"simulated frame 2 of 2, ", "rendered frame 1 of 2, ",
                            "rendered frame 2 of 2, 0:00 left, stretched ", " %, 0 sharp points\n"})
    EXPECT_NE(ended.err.find(words), std::string::npos) << words << " is not in\n" << ended.err;
  EXPECT_TRUE(bake({}).err.empty());
}

TEST_F(ProgressTest, ABakeWithoutACacheHasOnePass) {
  for (const auto& more :
       {std::vector<std::string>{"--formats", "maps,cert"}, {"--mesh", "simulation"}}) {
    auto words = more;
    words.insert(words.end(), {"--progress", "plain", "--resume", "never"});
    const Ended ended = run(crumple("1-2", words));
    EXPECT_NE(ended.err.find("simulated frame 2"), std::string::npos);
    EXPECT_EQ(ended.err.find("rendered"), std::string::npos) << ended.err;
  }
}

TEST_F(ProgressTest, JsonBeginsWithWhatWillBeDoneAndEndsWithTheResult) {
  const Ended ended = run(crumple(
      "2-3", {"--fps", "24", "--gravity", "-0.1", "--max-stretch", "1e-9", "--progress", "json"}));
  ASSERT_EQ(ended.code, 4) << ended.err;
  std::map<std::string, int> types;
  nlohmann::json first, last;
  for (const std::string& line : lines_of(ended.err)) {
    last = nlohmann::json::parse(line);
    if (first.is_null()) first = last;
    ++types[last.at("type")];
    if (last["type"] == "warning") {
      EXPECT_NE(last["message"].get<std::string>().find("pulls upwards"), std::string::npos);
    }
  }
  EXPECT_EQ(first["type"], "start");
  EXPECT_EQ(first["frames"], 2);
  EXPECT_EQ(first["first_frame"], 2);
  EXPECT_EQ(first["passes"], 2);
  EXPECT_EQ(first["name"], "S4_crumple");
  EXPECT_EQ(first["sheets"], nlohmann::json({"paper"}));
  EXPECT_EQ(last["type"], "end");
  EXPECT_EQ(last["exit_code"], 4);
  EXPECT_EQ(last["result"], "gates missed");
  EXPECT_EQ(last["gates_missed"].size(), static_cast<std::size_t>(types["gate"]));
  EXPECT_GT(last["files"].size(), 4u);
  EXPECT_TRUE(last["error"].is_null());
  EXPECT_EQ(types["start"], 1);
  EXPECT_EQ(types["end"], 1);
  EXPECT_EQ(types["frame"], 4);
  EXPECT_EQ(types["warning"], 1);
  EXPECT_GE(types["gate"], 1);
}

TEST_F(ProgressTest, WithoutProgressOneLineSaysWhyItEndedWithFour) {
  const Ended ended = run(crumple("1-2", {"--max-stretch", "1e-9", "--progress", "none"}));
  ASSERT_EQ(ended.code, 4) << ended.err;
  ASSERT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
  EXPECT_EQ(ended.err.rfind("gate missed: Frame", 0), 0u) << ended.err;
}

TEST_F(ProgressTest, ALogHasEveryLineWithItsTimeAndGoesOn) {
  const std::string log = folder / "bake.log";
  const Words words{"--fps", "24", "--progress", "none", "--log", log};
  ASSERT_EQ(run(crumple("1-2", words)).code, 0);
  ASSERT_EQ(run(crumple("1-2", words)).code, 0);  // nothing to do
  const std::vector<std::string> lines = lines_of(test::read(log));
  ASSERT_EQ(lines.size(), 8u) << test::read(log);
  const std::regex time("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z .*");
  for (const std::string& line : lines) EXPECT_TRUE(std::regex_match(line, time)) << line;
  EXPECT_NE(lines[0].find("S4_crumple, frames 1-2"), std::string::npos);
  EXPECT_NE(lines[1].find("simulated frame 1 of 2"), std::string::npos);
  EXPECT_NE(lines[5].find("done after 0:"), std::string::npos);
  EXPECT_NE(lines[7].find("done"), std::string::npos);
  EXPECT_TRUE(test::is_error(run(crumple("1-2", {"--log", folder / "missing" / "bake.log"})), 6,
                             folder / "missing" / "bake.log", "log"));
}

TEST_F(ProgressTest, SeveralSheetsAreNamed) {
  const Ended ended = run({"bake", test::samples + "/S11_palm.glb", "-o", output(), "--frames", "1",
                           "--formats", "cert", "--progress", "plain"});
  EXPECT_TRUE(std::regex_search(ended.err, std::regex("paper[^:\n]*: simulated frame 1")))
      << ended.err;
}

}  // namespace
}  // namespace paperbake
