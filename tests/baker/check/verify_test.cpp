// paperbake verify: an output folder against its certificate, and what one flipped byte does.

#include "baker/check/verify.h"

#include "core/geometry/random.h"
#include "tests/baker/program_fixture.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::CommandLine;
using test::Ended;
using test::read;
using test::samples;
using test::write;

class VerifyTest : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    ended = run(crumple("1-8", {}));
    ASSERT_EQ(ended.code, 0) << ended.err;
  }
  fs::path file(const std::string& name) const { return fs::path(output()) / name; }

  Ended ended{};
};

TEST_F(VerifyTest, ABakedFolderAgreesWithItsCertificate) {
  const Ended verdict = run({"verify", output(), "--json"});
  EXPECT_EQ(verdict.code, 0) << verdict.out;
  const auto json = nlohmann::json::parse(verdict.out);
  EXPECT_EQ(json["agrees"], true);
  EXPECT_EQ(json["frames"], 8);
  // cache, two maps, page, three of the certificate, singular.csv, job.lock.toml
  EXPECT_EQ(json["files"], 9);
  EXPECT_TRUE(json["first_frame_off"].is_null());
  write(file("notes.txt"), "of somebody else");
  EXPECT_EQ(run({"verify", output()}).code, 0);
}

TEST_F(VerifyTest, WhatIsFarFromTheOriginMayBeOffByTheRoundingOfItsCache) {
  test::GltfFixture scene;
  const double far = 90.3;  // [m], where numbers of 32 bits are 8 um apart
  scene.mesh("paper", test::grid(1, 1, 0.1, 0.1, nullptr,
                                 [&](double u, double v) { return Vector3d(far + u, v, 0); }));
  scene.node("handle.still", {far, 0, 0});
  scene.move(scene.node("handle.moves", {far + 0.1, 0, 0}), {1, 7},
             {{far + 0.1, 0, 0}, {far + 0.0837, 0.0123, 0.0171}});
  const std::string out = folder / "far";
  const Ended baked = run({"bake", scene.write("far.gltf").string(), "-o", out, "--formats",
                           "abc,cert", "--quality", "draft"});
  ASSERT_EQ(baked.code, 0) << baked.err;
  const Ended verdict = run({"verify", out});
  EXPECT_EQ(verdict.code, 0) << verdict.out;
}

TEST_F(VerifyTest, AFolderWithoutABakeIsACommandThatIsWrong) {
  fs::create_directories(folder / "holiday");
  write(folder / "holiday" / "notes.txt", "sun");
  EXPECT_TRUE(
      test::is_error(run({"verify", folder / "holiday"}), 2, folder / "holiday", "no bake"));
  fs::remove(file("cert/summary.json"));  // but a bake that lost its summary is not as certified
  EXPECT_EQ(run({"verify", output()}).code, 4);
}

TEST_F(VerifyTest, OneFlippedBitIsNoticedWhereverItIs) {
  int flips = 0;
  for (const auto& entry : fs::recursive_directory_iterator(output())) {
    // what the next bake needs is no result
    if (!entry.is_regular_file() || entry.path().parent_path().filename() == ".state") continue;
    const std::string whole = read(entry.path());
    ASSERT_FALSE(whole.empty()) << entry.path();
    for (int k = 0; k < 12; ++k) {
      std::string damaged = whole;
      const std::uint64_t draw = scramble(100 * flips++);
      damaged[draw % whole.size()] ^= static_cast<char>(1 << (draw >> 60 & 7));
      write(entry.path(), damaged);
      EXPECT_FALSE(verify(output()).differences.empty())
          << entry.path() << " at " << draw % whole.size();
    }
    write(entry.path(), whole);
  }
  EXPECT_EQ(flips, 9 * 12);
  EXPECT_TRUE(verify(output()).differences.empty());
}

TEST_F(VerifyTest, TheFirstFrameThatIsOffIsNamed) {
  std::string lines = read(file("cert/frames.jsonl"));
  const std::size_t fifth = lines.find("{\"frame\":5"),
                    field = lines.find("\"render_stretch_max_pct\":", fifth);
  ASSERT_NE(field, std::string::npos);
  // by more than the tolerance, whatever it was
  lines.insert(field + std::string("\"render_stretch_max_pct\":").size(), "1");
  write(file("cert/frames.jsonl"), lines);
  const Ended verdict = run({"verify", output(), "--json"});
  EXPECT_EQ(verdict.code, 4);
  const auto json = nlohmann::json::parse(verdict.out);
  EXPECT_EQ(json["first_frame_off"], 5);
  EXPECT_NE(std::string(json["differences"][0]["what"]).find("render_stretch_max_pct"),
            std::string::npos);
}

TEST_F(VerifyTest, AMissingFileIsADifference) {
  fs::remove(file("maps/S4_crumple.final.exr"));
  EXPECT_EQ(run({"verify", output()}).code, 4);
  fs::remove(file("cert/summary.json"));
  const Ended verdict = run({"verify", output()});
  EXPECT_EQ(verdict.code, 4);
  EXPECT_NE(verdict.out.find("cert/summary.json"), std::string::npos);
  EXPECT_EQ(run({"verify", output() + "/nowhere"}).code, 2);
}

TEST_F(VerifyTest, ABakeThatMissedItsGatesAgreesWithItsCertificateToo) {
  ended = run({"bake", samples + "/S1_push.glb", "-o", output(), "--frames", "1-30",
               "--max-stretch", "1e-9", "--formats", "abc,cert"});
  ASSERT_EQ(ended.code, 4);
  EXPECT_EQ(run({"verify", output()}).code, 0);
}

TEST_F(VerifyTest, AnInspectionDescribesABakedCache) {
  const auto json =
      nlohmann::json::parse(run({"inspect", file("S4_crumple.abc").string(), "--json"}).out);
  EXPECT_EQ(json["fps"], 24);
  EXPECT_EQ(json["sheets"][0]["last_frame"], 8);
  EXPECT_EQ(json["sheets"][0]["constant_topology"], true);
  EXPECT_EQ(json["metadata"]["_ai_Application"], "paperbake");
  write(file("S4_crumple.abc"), "no cache");
  EXPECT_EQ(run({"inspect", file("S4_crumple.abc").string()}).code, 3);
}

}  // namespace
}  // namespace paperbake
