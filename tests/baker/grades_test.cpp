// Every grade bakes the scene of one d-cone as paper does.

#include "formats/config/preset_file.h"
#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace paperbake {
namespace {

using test::read;

class GradesTest : public test::CommandLine, public testing::WithParamInterface<std::string> {};

TEST_P(GradesTest, EveryGradeMakesADConeWithoutStretching) {
  const test::Ended ended =
      run({"bake", test::samples + "/S8_dcone.glb", "-o", output(), "--preset", GetParam(),
           "--formats", "cert", "--mesh", "simulation", "--progress", "none"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto summary =
      nlohmann::json::parse(read(test::fs::path(output()) / "cert" / "summary.json"));
  EXPECT_EQ(summary["sheets"][0]["preset"], GetParam());
  EXPECT_LT(summary["stretch_mean_pct"]["max"], 0.1);  // worst of the thirteen: card300, 0.02
  EXPECT_LT(summary["stretch_max_pct"]["max"], 1);
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, GradesTest, testing::ValuesIn(preset_names()),
                         [](const auto& grade) { return grade.param; });

}  // namespace
}  // namespace paperbake
