// How far a bake is from finer paper, from its files alone.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace paperbake {
namespace {

using ErrorEstimateTest = test::CommandLine;
using test::Ended;
using test::is_error;
using test::samples;

TEST_F(ErrorEstimateTest, TheEstimateOfACoarseBakeIsLargerThanThatOfAFineOne) {
  const auto estimate = [&](const test::Words& method) {
    test::Words words{"bake",       samples + "/S1_push.glb",
                      "-o",         output(),
                      "--frames",   "1-24",
                      "--formats",  "abc,cert",
                      "--quality",  "draft",
                      "--progress", "none"};
    words.insert(words.end(), method.begin(), method.end());
    EXPECT_EQ(run(words).code, 0);
    const Ended judged = run({"verify", output(), "--estimate", "--json"});
    EXPECT_EQ(judged.code, 0) << judged.err;
    return nlohmann::json::parse(judged.out).at("estimates");
  };
  const auto coarse = estimate({"--method", "fem", "--triangles", "100"}),
             fine = estimate({"--method", "fem", "--triangles", "1000"});
  ASSERT_EQ(coarse.size(), 2u);  // frames 12, 24
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    EXPECT_EQ(coarse[k].at("frame"), 12 * (k + 1));
    EXPECT_EQ(coarse[k].at("uncertain"), "");
    EXPECT_GT(coarse[k].at("rms_pct").get<double>(), 0.1);
    // what the render mesh adds is left
    EXPECT_LT(fine[k].at("rms_pct").get<double>(), 0.5 * coarse[k].at("rms_pct").get<double>());
    EXPECT_EQ(fine[k].at("lower_branch_pct"), 0);
  }
}

TEST_F(ErrorEstimateTest, OfAFlatSheetNoShareOfItsEnergyIsTold) {
  ASSERT_EQ(run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--frames", "1-1", "--method",
                 "fem", "--triangles", "100", "--formats", "abc,cert", "--progress", "none"})
                .code,
            0);
  const Ended judged = run({"verify", output(), "--estimate", "--json"});
  ASSERT_EQ(judged.code, 0) << judged.err;
  const auto all = nlohmann::json::parse(judged.out);
  EXPECT_TRUE(all.at("estimates").at(0).at("energy_loss_pct").is_null());
  EXPECT_EQ(all.at("estimates").at(0).at("uncertain"), "");
  EXPECT_EQ(run({"verify", output(), "--estimate"}).out.find("energy"), std::string::npos);
}

TEST_F(ErrorEstimateTest, AFolderWithoutACacheCannotBeEstimated) {
  ASSERT_EQ(bake({"--formats", "cert"}).code, 0);
  EXPECT_TRUE(is_error(run({"verify", output(), "--estimate"}), 2, output(), "no cache"));
}

TEST_F(ErrorEstimateTest, ASheetThatSwingsCannotBeEstimatedNorOneThatLiesOnSomething) {
  ASSERT_EQ(bake({"--formats", "abc,cert", "--dynamics", "on"}).code, 0);
  EXPECT_TRUE(
      is_error(run({"verify", output(), "--estimate"}), 2, output(), "It moves with inertia"));
  ASSERT_EQ(run({"bake", samples + "/S5_roll.glb", "-o", output(), "--frames", "1-24", "--formats",
                 "abc,cert", "--quality", "draft", "--progress", "none"})
                    .code %
                4,
            0);
  const Ended judged = run({"verify", output(), "--estimate", "--json"});
  ASSERT_EQ(judged.code, 0) << judged.err;
  int on_ground = 0;
  const auto all = nlohmann::json::parse(judged.out);
  for (const auto& estimate : all.at("estimates"))
    if (estimate.at("uncertain") == "the sheet lies on a collider, which is not in the files")
      on_ground += estimate.at("rms_pct").is_null();
  EXPECT_GT(on_ground, 0);
}

TEST_F(ErrorEstimateTest, ACertificateOfAnotherSheetCannotBeEstimated) {
  ASSERT_EQ(bake({"--formats", "abc,cert"}).code, 0);
  const auto handles = std::filesystem::path(output()) / "cert/handles.csv";
  std::string text = test::read(handles);
  const std::size_t at = text.find("\n1,");
  ASSERT_NE(at, std::string::npos);
  test::write(handles, text.insert(at + 3, "another"));
  EXPECT_TRUE(is_error(run({"verify", output(), "--estimate"}), 2, output() + "/cert",
                       "not that of the cache"));
}

}  // namespace
}  // namespace paperbake
