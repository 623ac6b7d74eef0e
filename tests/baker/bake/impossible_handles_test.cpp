// Handles that ask more of the paper than it can reach. Everything is checked from outside.

#include "tests/baker/program_fixture.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using ImpossibleHandlesTest = test::CommandLine;
using test::Ended;
using test::is_error;
using test::read;

/// A sheet of 10 cm whose two lower corners are drawn apart, evenly, to `factor` times their
/// distance in frames 1-13.
fs::path drawn_apart(double factor) {
  test::GltfFixture scene;
  scene.mesh("paper", test::grid(1, 1, 0.1, 0.1));
  scene.node("handle.still", {0, 0, 0});
  scene.move(scene.node("handle.drawn", {0.1, 0, 0}), {1, 13}, {{0.1, 0, 0}, {0.1 * factor, 0, 0}});
  return scene.write("drawn_apart.gltf");
}

TEST_F(ImpossibleHandlesTest, HandlesThatAskTheImpossibleAreNamedAndEndWithFour) {
  const std::string scene = drawn_apart(1.1);
  const Ended ended = run({"bake", scene, "-o", output(), "--triangles", "50", "--map-size", "8"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_NE(ended.err.find("\"handle.still\" and \"handle.drawn\""), std::string::npos)
      << ended.err;
  EXPECT_NE(ended.err.find("overshoot 10.00 mm (10.0 %)"), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("gate missed: "), std::string::npos) << ended.err;
  const auto summary = nlohmann::json::parse(read(fs::path(output()) / "cert" / "summary.json"));
  EXPECT_EQ(summary["exit_code"], 4);
  EXPECT_EQ(summary["impossible_handles"].size(), 1u);
  EXPECT_TRUE(fs::exists(fs::path(output()) / "drawn_apart.abc")) << "it is baked all the same";
  EXPECT_LT(double(summary["stretch_max_pct"]["max"]), 5)
      << "the request is projected to what paper can reach";
}

TEST_F(ImpossibleHandlesTest, StrictRefusesTheImpossibleWithThreeBeforeAnythingIsWritten) {
  const std::string scene = drawn_apart(1.1);
  const std::string place = scene + ", handles \"handle.still\" and \"handle.drawn\"";
  EXPECT_TRUE(
      is_error(run({"bake", scene, "-o", output(), "--strict"}), 3, place, "overshoot 10.00 mm"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(ImpossibleHandlesTest, HandlesThatComeCloserAskNothingImpossible) {
  const Ended ended = run({"bake", drawn_apart(0.9), "-o", output(), "--triangles", "50",
                           "--map-size", "8", "--strict"});
  EXPECT_EQ(ended.code, 0) << ended.err;
}

}  // namespace
}  // namespace paperbake
