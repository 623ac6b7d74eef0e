// Handles that ask more of the paper than it can reach. Everything is checked from outside.

#include "tests/baker/program_fixture.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

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

TEST_F(ImpossibleHandlesTest, NoiseInKeysThatNoGateMindsIsAWarning) {
  const Ended ended = run({"bake", drawn_apart(1.008).string(), "-o", output(), "--triangles", "50",
                           "--map-size", "8"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.err.find("Handles of sheet \"paper\" are keyed up to 0.80 mm too far apart (1 "
                           "pair; the worst are \"handle.still\" and \"handle.drawn\" at frame "
                           "13)"),
            std::string::npos)
      << ended.err;
  EXPECT_EQ(run({"bake", drawn_apart(1.008).string(), "--strict", "--dry-run"}).code, 3);
  const Ended farther = run({"bake", drawn_apart(1.012).string(), "--dry-run"});
  EXPECT_EQ(farther.code, 4) << "1.2 mm is more than a handle may be off: " << farther.err;
}

TEST_F(ImpossibleHandlesTest, ATautSheetThatStandsStillIsNotSaidToBeUnsolved) {
  test::GltfFixture scene;
  scene.mesh("paper", test::grid(1, 1, 0.1, 0.1));
  for (const auto& [name, y] : {std::pair("low", 0.0), {"high", 0.1}})
    for (const double x : {0.0, 0.1})
      scene.move(scene.node(fmt::format("handle.{}.{}", name, x), {x, y, 0}), {1, 13},
                 {{x, y, 0}, {0.05 + 1.5 * (x - 0.05), y, 0}});
  const Ended ended = run({"bake", scene.write("taut.gltf").string(), "-o", output(), "--triangles",
                           "50", "--map-size", "8"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_NE(ended.err.find("keyed beyond the reach"), std::string::npos) << ended.err;
  EXPECT_EQ(ended.err.find("not solved"), std::string::npos) << ended.err;
  EXPECT_EQ(read(fs::path(output()) / "cert/frames.jsonl").find("not solved"), std::string::npos);
}

TEST_F(ImpossibleHandlesTest, ARelativeHandleThatPullsThePaperTautIsToldWithTheHandleThatHoldsIt) {
  test::GltfFixture scene;
  scene.mesh("paper", test::grid(1, 1, 0.1, 0.1));
  scene.node("handle.still", {0, 0, 0});
  scene.move(scene.node("handle.pulls", {0.1, 0, 0}, R"({"paper_mode":"relative"})"), {1, 13},
             {{0.1, 0, 0}, {0.12, 0, 0}});
  const Ended ended = run({"bake", scene.write("pulls.gltf").string(), "-o", output(),
                           "--triangles", "50", "--map-size", "8"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_NE(ended.err.find("\"handle.still\" is keyed farther from \"handle.pulls\" than"),
            std::string::npos)
      << ended.err;
  EXPECT_EQ(ended.err.find("attempt"), std::string::npos) << "none can mend it: " << ended.err;
}

/// Handles that go 30 mm down into a table, and 0.1 mm farther than the paper reaches.
TEST_F(ImpossibleHandlesTest, WhatATableHoldsBackIsNotSaidToBeTaut) {
  test::GltfFixture scene;
  scene.mesh("paper", test::grid(1, 1, 0.1, 0.1));
  scene.mesh("collider.table", test::grid(1, 1, 1, 1, nullptr, [](double u, double v) {
               return Vector3d(u - 0.5, v - 0.5, -0.001);
             }));
  std::vector<int> frames;
  for (int f = 1; f <= 13; ++f) frames.push_back(f);
  for (const double y : {0.0, 0.1}) {
    scene.node(fmt::format("handle.still.{}", y), {0, y, 0});
    std::vector<Vector3d> way;
    for (const int f : frames) {
      const double down = 0.03 * (f - 1) / 12, far = 0.1 + 1e-4 * (f - 1) / 12;
      way.emplace_back(std::sqrt(far * far - down * down), y, -down);
    }
    scene.move(
        scene.node(fmt::format("handle.pulls.{}", y), {0.1, y, 0}, R"({"paper_mode":"relative"})"),
        frames, way);
  }
  const Ended ended = run({"bake", scene.write("blocked.gltf").string(), "-o", output(),
                           "--triangles", "50", "--map-size", "8"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_NE(ended.err.find("is jammed; the sheet touches the collider"), std::string::npos)
      << ended.err;
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

/// A4 with four handles on each third, the lower ones on the edge; in the last frame it is folded
/// at 99 and 198 mm, by 172 and 165 degrees.
fs::path letter_with_held_edge() {
  test::GltfFixture scene;
  scene.mesh("paper", test::grid(1, 1, 0.210, 0.297));
  const auto fold = [](double length, double degrees, double at, double towards) {
    const double angle = degrees * M_PI / 180;
    return std::pair(at + towards * length * std::cos(angle), length * std::sin(angle));
  };
  const auto add = [&](const std::string& name, double x, double y) {
    const auto [end, up] = y < 0.099   ? fold(0.099 - y, 172, 0.099, -1)
                           : y > 0.198 ? fold(y - 0.198, 165, 0.198, 1)
                                       : std::pair(y, 0.0);
    scene.move(scene.node(name, {x, y, 0}), {1, 13}, {{x, y, 0}, {x, end, up}});
  };
  const std::array<const char*, 3> names{"handle.bottom.", "handle.middle.", "handle.top."};
  const double near[] = {0, 0.184, 0.2475}, far[] = {0.066, 0.110, 0.297};
  for (int third = 0; third < 3; ++third) {
    add(names[third] + std::string("0"), 0, near[third]);
    add(names[third] + std::string("1"), 0.210, near[third]);
    add(names[third] + std::string("2"), 0, far[third]);
    add(names[third] + std::string("3"), 0.210, far[third]);
  }
  return scene.write("letter.gltf");
}

TEST_F(ImpossibleHandlesTest, ALayerThatIsTooShortToGoRoundAnotherIsToldBeforeTheBake) {
  const std::string scene = letter_with_held_edge();
  const Ended inspected = run({"inspect", scene});
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_NE(inspected.out.find("impossible: Handles \"handle."), std::string::npos)
      << inspected.out;
  EXPECT_NE(inspected.out.find("frame 13 the way round it is 65.83 mm long"), std::string::npos)
      << inspected.out;
  EXPECT_NE(inspected.out.find("2.33 mm short"), std::string::npos) << inspected.out;
  const auto all = nlohmann::json::parse(run({"inspect", scene, "--json"}).out);
  ASSERT_EQ(all.at("impossible_handles").size(), 1u);
  EXPECT_EQ(all["impossible_handles"][0].at("around"), "handle.bottom.0");
  const Ended strict = run({"bake", scene, "-o", output(), "--strict"});
  EXPECT_EQ(strict.code, 3) << strict.err;
  EXPECT_NE(strict.err.find("2.33 mm short"), std::string::npos) << strict.err;
}

}  // namespace
}  // namespace paperbake
