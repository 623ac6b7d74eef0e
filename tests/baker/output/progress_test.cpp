// What a bake tells of how far it is, on stderr.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <string>

namespace paperbake {
namespace {

using ProgressTest = test::CommandLine;
using test::Ended;
using test::lines_of;

TEST_F(ProgressTest, BothPassesOfABakeTellOfEveryFrame) {
  const Ended ended = run(crumple("1-3", {"--fps", "24", "--progress", "json"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  std::map<std::string, int> done;
  for (const std::string& line : lines_of(ended.err)) {
    const auto given = nlohmann::json::parse(line);
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

TEST_F(ProgressTest, APlainBakeSaysWhichPassIsAtWhichFrame) {
  const Ended ended = run(crumple("1-2", {"--fps", "24", "--progress", "plain"}));
  for (const char* words : {"paper simulated frame 2 (2/2)", "paper rendered frame 1 (1/2)",
                            "paper rendered frame 2 (2/2)  0:00 left"})
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

}  // namespace
}  // namespace paperbake
