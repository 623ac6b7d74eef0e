#include "baker/studies/accuracy_search.h"

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace paperbake {
namespace {

using Json = nlohmann::json;
using test::Ended;
using test::read;
using test::samples;
using test::Words;
namespace fs = std::filesystem;

/// Distances between results on n and 2n triangles of which the error is c n^-q, frame by frame.
std::vector<double> distances(double n, double q, const std::vector<double>& c) {
  std::vector<double> all;
  for (const double factor : c) all.push_back(factor * (std::pow(n, -q) - std::pow(2 * n, -q)));
  return all;
}

TEST(AccuracySearchTest, FindsTheErrorOfAPowerLaw) {
  const std::vector<double> c{10, 30, 20};
  for (const double q : {0.5, 1.0, 1.9}) {
    const std::vector<double> errors = estimated_errors(distances(120, q, c), distances(240, q, c));
    for (std::size_t f = 0; f < c.size(); ++f)
      EXPECT_NEAR(errors[f], c[f] * std::pow(240, -q), 1e-9) << q;
  }
  // from two results alone: as if the error were proportional to the area of a triangle
  const std::vector<double> first = estimated_errors({}, distances(120, 1, c));
  EXPECT_NEAR(first[1], 30.0 / 120, 1e-12);
}

TEST(AccuracySearchTest, ResultsThatDoNotConvergeHaveLargeErrors) {
  const std::vector<double> errors = estimated_errors({0.1, 0.1, 0.1}, {0.2, 0.2, 0.2});
  EXPECT_NEAR(errors[0], 4 * 0.2, 1e-12);
}

TEST(AccuracySearchTest, FindsTheFrameInWhichMeshesPart) {
  const std::vector<double> coarser{0.2, 0.2, 0.2, 0.2, 0.2, 0.2, 0.2, 0.2};
  // one bad frame among good ones is no parting; neither are distances below what matters
  EXPECT_EQ(parting_frame(coarser, {0.1, 0.5, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}, 0.3), 8u);
  EXPECT_EQ(parting_frame(coarser, {0.1, 0.1, 0.1, 0.1, 0.25, 0.25, 0.25, 0.25}, 0.3), 8u);
  EXPECT_EQ(parting_frame(coarser, {0.1, 0.1, 0.1, 0.1, 0.9, 0.9, 0.9, 0.9}, 0.3), 4u);
  // the two may come near each other again for a moment
  EXPECT_EQ(parting_frame(coarser, {0.1, 0.1, 0.9, 0.9, 0.1, 0.9, 0.9, 0.9}, 0.3), 2u);
}

TEST(AccuracySearchTest, ASizeThatBeginsOnTheMeshOfTheOneBeforeItMeasuresNothing) {
  // as where a rehearsal makes both first meshes finer
  BakeSettings settings;
  settings.scene = samples + "/S1_push.glb";
  settings.frames = FrameSpan{1, 8, 1};
  settings.base_triangles = 120;
  settings.given["base_triangles"] = {"120", Origin::command};
  settings.accuracy = 1;
  std::vector<int> planned;
  const BakePlan plan = plan_with_accuracy(
      settings, [](const std::string&) {},
      [&](BakeSettings with) {
        planned.push_back(with.base_triangles);
        with.base_triangles = std::max(with.base_triangles, 240);
        return plan_bake(with);
      });
  EXPECT_EQ(planned, (std::vector<int>{120, 240, 480, 120})) << "the last one is the bake's";
  ASSERT_TRUE(plan.accuracy);
  EXPECT_EQ(plan.accuracy->size, 120);
  ASSERT_EQ(plan.accuracy->tried.size(), 2u);
  EXPECT_GT(plan.accuracy->error_pct, 0);
}

TEST(AccuracySearchTest, WhereMeshesPartDoesNotDependOnTheAccuracy) {
  // in frame 32: from there on no mesh is nearer to the truth, whatever is asked for
  BakeSettings settings;
  settings.scene = samples + "/S8_dcone.glb";
  int finer = 0;
  for (const double pct : {1.0, 0.3}) {
    BakeSettings with = settings;
    with.accuracy = pct;
    const BakePlan plan = plan_with_accuracy(with, [](const std::string&) {});
    ASSERT_TRUE(plan.accuracy);
    EXPECT_EQ(plan.accuracy->parts_in_frame, 32) << pct;
    EXPECT_GE(plan.accuracy->size, finer) << pct;
    EXPECT_TRUE(plan.accuracy->is_reached) << pct;
    finer = plan.accuracy->size;
  }
}

class AccuracyCommandTest : public test::CommandLine {
 protected:
  Ended bake_push(const Words& more) const {
    Words words{"bake",      samples + "/S1_push.glb",
                "-o",        output(),
                "--frames",  "1-24",
                "--mesh",    "simulation",
                "--formats", "cert",
                "--resume",  "never"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  Json accuracy() const {
    return Json::parse(read(fs::path(output()) / "cert" / "summary.json"))["accuracy"];
  }
};

TEST_F(AccuracyCommandTest, AsksForFinerMeshesTheMoreExactTheFramesAreToBe) {
  int coarser = 0;
  for (const char* pct : {"1", "0.2"}) {
    const Ended bake = bake_push({"--accuracy", pct, "--progress", "plain"});
    EXPECT_EQ(bake.code, 0) << bake.err;
    const Json chosen = accuracy();
    EXPECT_EQ(chosen["asked_pct"], std::stod(pct));
    EXPECT_TRUE(chosen["reached"]);
    EXPECT_LE(chosen["error_pct"], std::stod(pct));
    EXPECT_EQ(chosen["frame_error_pct"].size(), 24u);
    EXPECT_GT(chosen["base_triangles"], coarser);
    coarser = chosen["base_triangles"];
    // the bake used what was chosen
    const std::string lock = read(fs::path(output()) / "job.lock.toml");
    EXPECT_NE(lock.find("base_triangles = " + std::to_string(coarser)), std::string::npos) << lock;
    EXPECT_NE(bake.err.find("accuracy: hybrid with " + std::to_string(coarser)), std::string::npos)
        << bake.err;
  }
}

TEST_F(AccuracyCommandTest, ASizeThatIsGivenStaysAndItsErrorIsEstimated) {
  bake_push({"--accuracy", "0.01", "--base-triangles", "100"});
  const Json chosen = accuracy();
  EXPECT_EQ(chosen["base_triangles"], 100);
  EXPECT_FALSE(chosen["reached"]);
  EXPECT_GT(chosen["error_pct"], 0.01);
  EXPECT_EQ(chosen["tried"].size(), 2u);
}

TEST_F(AccuracyCommandTest, ALimitOfTheMeshDoesNotHideItsError) {
  bake_push({"--accuracy", "0.01", "--triangles", "130"});
  const Json chosen = accuracy();
  EXPECT_EQ(chosen["base_triangles"], 120);
  EXPECT_FALSE(chosen["reached"]);
  EXPECT_GT(chosen["error_pct"], 0.01);
}

TEST_F(AccuracyCommandTest, ABudgetThatIsTooSmallForAnySearchTakesTheFirstSize) {
  bake_push({"--budget", "0.001"});
  const Json chosen = accuracy();
  EXPECT_EQ(chosen["base_triangles"], 120);
  EXPECT_EQ(chosen["tried"].size(), 1u);
  EXPECT_TRUE(chosen["error_pct"].is_null());
}

TEST_F(AccuracyCommandTest, ACrumpleHasNoAnswerThatMeshesComeNearerTo) {
  run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--frames", "1-60", "--mesh",
       "simulation", "--formats", "cert", "--accuracy", "5"});
  const Json chosen = accuracy();
  ASSERT_TRUE(chosen["parts_in_frame"].is_number());
  const int parts = chosen["parts_in_frame"];
  EXPECT_GT(parts, 1);
  EXPECT_LT(parts, 60);
  EXPECT_LT(chosen["frame_error_pct"].size(), static_cast<std::size_t>(parts));
}

TEST(AccuracyChoice, SaysOfHowManyFramesItsEstimateIsAndWhenThereIsNone) {
  AccuracyChoice choice;
  choice.method = "hybrid";
  choice.size = 120;
  EXPECT_NE(describe(choice).find("no time to estimate"), std::string::npos);
  choice.frame_error_pct = {0.01, 0.02};
  choice.error_pct = 0.02;
  EXPECT_NE(describe(choice).find("nine of ten frames are"), std::string::npos);
  choice.parts_in_frame = 3;
  EXPECT_NE(describe(choice).find("nine of ten frames of the 2 before frame 3 are"),
            std::string::npos);
  choice.frame_error_pct.clear();  // they part from the first frame on
  EXPECT_EQ(describe(choice).find("estimate"), std::string::npos);
}

}  // namespace
}  // namespace paperbake
